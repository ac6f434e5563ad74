#!/usr/bin/env bash
# Runs docs/cluster/Snakefile for real, on two movies of different kinds, and again once a verdict and the table are lost. Needs Snakemake.
#
#     tests/cluster/workflow.sh [PROGRAM]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=${1:-$root/target/release/voronudge}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/movies"
cp "$root"/fixtures/examples/{masks.tif,tracks.xml} "$scratch/movies"
cd "$scratch"

verdicts() {
    snakemake --snakefile "$root/docs/cluster/Snakefile" --cores 2 --config out=verdicts voronudge="$program" >log 2>&1 ||
        { cat log >&2; exit 1; }
}

verdicts
sed 's/^/    /' verdicts/verdicts.csv
for movie in masks tracks; do
    grep -q "^$movie,nothing_missing," verdicts/verdicts.csv
done

kept=$(stat -c %Y verdicts/masks/verdict/report.json)
rm verdicts/tracks/verdict/report.json verdicts/verdicts.csv
verdicts
[ -f verdicts/tracks/verdict/report.json ]
[ "$(wc -l <verdicts/verdicts.csv)" = 3 ]
[ "$(stat -c %Y verdicts/masks/verdict/report.json)" = "$kept" ]
echo "workflow of two movies: both verdicts, and only what was lost is made again"
