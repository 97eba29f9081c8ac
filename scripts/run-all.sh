#!/usr/bin/env bash
# Run the five experiments of the paper one after the other, a report of each under the given folder.
set -u
corpuscle=$1
out=$2
worst=0
for experiment in brownian entropy ideal-gas three-body wave; do
    "$corpuscle" run "$experiment" --out "$out/$experiment" --force
    code=$?
    [ "$code" -gt "$worst" ] && worst=$code
done
echo
echo "Reports: $out/*/report.html"
exit "$worst"
