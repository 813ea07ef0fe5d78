#!/bin/sh
# Puts what runs before have found, and the small files of the tests, into the corpora.
cd "$(dirname "$0")/.." || exit 1
for kind in obj nff toml image; do
    mkdir -p "fuzz/corpus/$kind"
    tar -C "fuzz/corpus/$kind" -xJf "fuzz/corpus/$kind.tar.xz"
done
find tests/broken/obj -name '*.obj' -size -8k -exec cp {} fuzz/corpus/obj/ \;
for library in tests/broken/obj/*.mtl models/*/*.mtl; do
    { printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n#mtl\n'; cat "$library"; } \
        > "fuzz/corpus/obj/$(basename "$library").obj"
done
cp tests/broken/nff/*.nff fuzz/corpus/nff/
cp tests/broken/toml/*.toml src/scene/builtin/*.toml fuzz/corpus/toml/
find models tests/broken textures -size -12k \( -name '*.png' -o -name '*.jpg' \) -exec cp {} fuzz/corpus/image/ \;
