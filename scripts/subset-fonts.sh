#!/usr/bin/env bash
# Cut Noto Sans SC down to the characters that the window can say, for crates/lab/fonts/. Needed again when language/table.rs or
# language/phrases.tsv gain characters: a test of the lab names those that are missing.
#
#   scripts/subset-fonts.sh FOLDER    with NotoSansSC-Regular.ttf and NotoSansSC-SemiBold.ttf, from the Noto project
#
# Dots, quotation marks and signs such as × are as wide as a Chinese character in this font: they come from DejaVu Sans.
# Needs Python's fonttools. Noto Sans SC is under the SIL Open Font License 1.1, which allows this (crates/lab/fonts/OFL.txt).
set -euo pipefail
folder=$1
cd "$(dirname "$0")/../crates/lab"
for weight in Regular SemiBold; do
    pyftsubset "$folder/NotoSansSC-$weight.ttf" \
        --text-file=<(cat src/language/table.rs src/language/phrases.tsv src/language.rs | sed 's/[…·“”‘’×°±]//g') \
        --unicodes="U+20-7E,U+A0-AF,U+C0-D6,U+D8-F6,U+F8-FF,U+2013,U+2014,U+3000-3003,U+3008-3011,U+FF01,U+FF08,U+FF09,U+FF0C,U+FF1A,U+FF1B,U+FF1F" \
        --layout-features='kern,liga,locl,mark,mkmk,tnum' --no-hinting --desubroutinize --drop-tables+=DSIG,vhea,vmtx,STAT \
        --name-IDs=0,1,2,4,6,13,14 --output-file="fonts/NotoSansSC-$weight.subset.ttf"
done
ls -l fonts
