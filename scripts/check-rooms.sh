#!/usr/bin/env bash
# The rooms below the renderer build without any graphics dependency: their dependency trees hold none.
set -euo pipefail
for room in checkpoint core event time observe scene experiments bench io; do
    if cargo tree --locked -p "corpuscle-$room" -e normal --prefix none | grep -Eq '^(glow|glutin|winit|egui|corpuscle-render)'; then
        echo "corpuscle-$room depends on graphics" >&2
        exit 1
    fi
done
echo "no graphics below the renderer"
