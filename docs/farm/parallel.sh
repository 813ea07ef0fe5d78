#!/bin/bash
# A picture in tiles on several machines by GNU parallel over ssh, joined at the end:
#
#     HOSTS=4/one.example,8/two.example,: TILES=64 ./parallel.sh picture.exr scene.toml --size 8192x8192
#
# HOSTS is what `parallel --sshlogin` takes; `:` is this machine, and alone the default. The folder, the scene and the program
# must be in the same place on all machines. A tile that fails is tried three times; called again, only the tiles that are
# missing are rendered, from their checkpoints if they have any.
set -euo pipefail

output=$1
shift
tiles=${TILES:-64}
stem=${output%.*}
kind=${output##*.}

seq "$tiles" | parallel --sshlogin "${HOSTS:-:}" --workdir "$PWD" --jobs "${JOBS:-1}" --retries 3 --joblog "$stem.log" --quote \
    "${WHITTED:-whitted}" render "$@" --quiet --resume --tile "{}/$tiles" -o "$stem-{}of$tiles.$kind"

seq "$tiles" | sed "s|.*|$stem-&of$tiles.$kind|" | xargs "${WHITTED:-whitted}" merge -o "$output"
