#!/usr/bin/env bash
# Installs what evbench is built with (packages.txt, Debian 12) and builds a preset, release or another, all of it or one
# target: ./setup.sh fuzz; ./setup.sh release evbench
set -euo pipefail
cd "$(dirname "$0")"
for argument in "$@"; do
  case $argument in
    -h | --help) sed -n '2,3s/^# //p' setup.sh && exit ;;
    -*) echo "setup.sh: $argument is no preset or target" >&2 && exit 2 ;;
  esac
done
preset=${1:-release}

missing=()
while read -r package; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done < <(grep -v '^#' packages.txt)
if [ ${#missing[@]} -gt 0 ]; then
  echo "== installing ${missing[*]}"
  sudo=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup.sh: these packages are missing, and installing them needs root or sudo" >&2; exit 1; }
    sudo=sudo
  fi
  $sudo apt-get update -qq
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

echo "== building (preset $preset, in build/$preset)"
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" ${2:+--target "$2"} -- --quiet
