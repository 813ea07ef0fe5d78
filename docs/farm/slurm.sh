#!/bin/bash
# A picture in 64 tiles on a Slurm cluster, joined at the end. Call it from a folder that all nodes see:
#
#     sbatch --array=1-64 slurm.sh scene.toml --size 8192x8192
#
# A task that fails, is cancelled or runs out of time leaves a checkpoint and is put into the queue again, up to Slurm's limit;
# --resume goes on from there. The last task joins the tiles. `scontrol requeue JOB_TASK` renders one again.
#SBATCH --job-name=whitted
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --mem=2G
#SBATCH --time=01:00:00
#SBATCH --requeue
# SIGTERM two minutes before the end, so that there is time to write a checkpoint.
#SBATCH --signal=TERM@120
set -u

# To submit a few tiles again, say how many there are in all: TILES=64 sbatch --array=5,17 ...
tiles=${TILES:-$SLURM_ARRAY_TASK_MAX}
tile="$SLURM_ARRAY_TASK_ID/$tiles"
part="tile-${SLURM_ARRAY_TASK_ID}of$tiles.exr"

srun whitted render "$@" --tile "$tile" -o "$part" --resume --threads "${SLURM_CPUS_PER_TASK:-1}"
code=$?
if [ "$code" -eq 143 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
fi
[ "$code" -eq 0 ] || exit "$code"

# Whoever finds all the tiles joins them; merge refuses as long as one is missing.
whitted merge tile-*of"$tiles".exr -o picture.exr 2>/dev/null || true
