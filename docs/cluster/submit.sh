#!/bin/bash
# Runs a command as a job array of Slurm, and puts its parts together:
#
#     submit.sh FOLDER PARTS COMMAND [OPTIONS…]
#     submit.sh diagram 64 phase-diagram --P_0 3 4.2 32 --alpha 0 3 32 --replicas 8 --seed 1
#
# Results are in FOLDER/whole. Submitted once more it makes only what is missing. Options for sbatch, such as an account or
# a partition, are taken from the environment (SBATCH_ACCOUNT, SBATCH_PARTITION, SBATCH_TIMELIMIT); VORONUDGE is the program.
# With WAIT=1 it waits for the end, and fails if there is no whole.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$1 parts=$2
shift 2
mkdir -p "$folder"
cd "$folder"
rm -rf whole
array=$(sbatch --parsable --array="1-$parts" "$here/array.sbatch" "$@")
merge=$(sbatch --parsable --dependency="afterany:$array" --kill-on-invalid-dep=yes "$here/merge.sbatch")
echo "parts: job $array, whole: job $merge"
if [ "${WAIT:-}" ]; then
    # The answer of `sbatch --wait` is 0 for a job that was cancelled: look at what there is.
    while squeue --noheader --jobs "$array,$merge" 2>/dev/null | grep -q .; do sleep 1; done
    test -f whole/report.json || { cat log-merge.txt >&2; exit 1; }
fi
