#!/usr/bin/env bash
# Install what building (run) and testing (test) need beyond Rust. Debian and Ubuntu: by itself. Elsewhere: say what is missing.
set -euo pipefail
purpose=${1:-run}

if ! command -v cargo >/dev/null; then
    echo "corpuscle: Rust is missing. Install it with rustup (https://rustup.rs), then run this again." >&2
    exit 1
fi

# Programs that read trajectories, from PyPI, in an environment of their own beside what is built. About 900 MB, most of it OVITO's.
readers() {
    [ "$purpose" = test ] || return 0
    local here wanted
    here=$(cd "$(dirname "$0")/.." && pwd)
    wanted="$here/scripts/requirements.txt"
    local environment="${CARGO_TARGET_DIR:-$here/target}/readers"
    cmp -s "$wanted" "$environment/installed.txt" && return 0
    echo "corpuscle: installing the readers of scripts/requirements.txt"
    rm -rf "$environment"
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet --disable-pip-version-check --requirement "$wanted"
    cp "$wanted" "$environment/installed.txt"
}

case "$(uname -s)" in
    Linux) ;;
    Darwin)
        # macOS brings OpenGL and, with its command line tools, a compiler.
        xcode-select -p >/dev/null 2>&1 || { echo "corpuscle: run 'xcode-select --install' first." >&2; exit 1; }
        readers
        exit 0 ;;
    *) exit 0 ;; # Windows: rustup's own installer asks for the compiler; the graphics driver brings OpenGL
esac

# What to look for, and the Debian package that brings it.
missing=()
has_library() { { ldconfig -p 2>/dev/null || /sbin/ldconfig -p; } | grep -q "$1"; }
need_command() { command -v "$1" >/dev/null || missing+=("$2"); }
need_library() { has_library "$1" || missing+=("$2"); }

need_command cc gcc
need_command c++ g++                      # the video encoder is C++
need_library libEGL.so.1 libegl1          # OpenGL without a display
need_library libGL.so.1 libgl1
ls /usr/lib/*/dri/*_dri.so /usr/lib/dri/*_dri.so >/dev/null 2>&1 || missing+=(libgl1-mesa-dri) # Mesa's drivers, the software one too
need_library libxkbcommon-x11.so.0 libxkbcommon-x11-0 # a window under X11
need_library libXcursor.so.1 libxcursor1
need_library libXi.so.6 libxi6
if [ "$purpose" = test ]; then
    need_command Xvfb xvfb                # a display in memory, for the window's tests
    need_command xdotool xdotool          # real key presses
    need_command python3 python3          # the programs that read trajectories
    python3 -c 'import ensurepip' 2>/dev/null || missing+=(python3-venv)
fi

[ ${#missing[@]} -eq 0 ] && { readers; exit 0; }
if ! command -v apt-get >/dev/null; then
    echo "corpuscle: missing: ${missing[*]} (Debian's names). Install your system's equivalents:" >&2
    echo "  Fedora: dnf install gcc-c++ mesa-dri-drivers mesa-libEGL mesa-libGL libxkbcommon-x11 libXcursor libXi xorg-x11-server-Xvfb xdotool" >&2
    echo "  Arch:   pacman -S gcc mesa libglvnd libxkbcommon-x11 libxcursor libxi xorg-server-xvfb xdotool" >&2
    exit 1
fi
sudo=
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "corpuscle: run as root: apt-get install ${missing[*]}" >&2; exit 1; }
    sudo=sudo
fi
echo "corpuscle: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
$sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
readers
