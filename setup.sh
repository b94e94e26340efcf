#!/usr/bin/env bash
# Installs the packages that evbench needs (packages.txt; Debian and its relatives) and builds it, in build/PRESET.
#   ./setup.sh [--for figures|report|tests]... [--set OPTION=VALUE]... [PRESET [TARGET...]]
# PRESET: release (default), or another one of CMakePresets.json. --for: packages for more than building and running; with
# "tests" the tests are built, too. --set: an option of CMakeLists.txt, e.g. EVBENCH_MICRO=ON; it stays until it is set anew.
set -euo pipefail
cd "$(dirname "$0")"

purposes=(build run)
options=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) sed -n '2,5s/^# //p' setup.sh && exit ;;
    --for)
      [ $# -gt 1 ] && grep -qx "\[$2\]" packages.txt || { echo "setup.sh: --for needs a section of packages.txt" >&2; exit 2; }
      purposes+=("$2")
      [ "$2" = tests ] && options+=(-DEVBENCH_TESTS=ON)
      shift 2 ;;
    --set)
      [[ ${2:-} == *=* ]] || { echo "setup.sh: --set needs OPTION=VALUE, an option of CMakeLists.txt" >&2; exit 2; }
      options+=("-D$2")
      shift 2 ;;
    -*) echo "setup.sh: there is no option $1; ./setup.sh --help lists them" >&2 && exit 2 ;;
    *) break ;;
  esac
done
preset=${1:-release}
[ $# -gt 0 ] && shift
grep -q "\"name\": \"$preset\"" CMakePresets.json || { echo "setup.sh: there is no preset $preset in CMakePresets.json" >&2; exit 2; }

# The lines of packages.txt below the headings of the purposes.
wanted() {
  local heading= line
  while read -r line; do
    case $line in
      '' | '#'*) ;;
      '['*']') heading=${line:1:-1} ;;
      *) [[ " ${purposes[*]} " != *" $heading "* ]] || echo "$line" ;;
    esac
  done < packages.txt
}
# Whether a package is installed, or another one that provides it (as some packages of Node.js provide npm).
installed() {
  dpkg-query -W -f='${db:Status-Status} ${Package}, ${Provides},\n' 2>/dev/null | sed 's/ ([^)]*)//g' |
    grep -E "^installed (.* )?$(printf '%s' "$1" | sed 's/[.+]/\\&/g')," >/dev/null
}
exists() { apt-cache show --no-all-versions "$1" >/dev/null 2>&1; }

# One name a line of what is missing: the first of a line's alternatives that the distribution has.
missing() {
  local clang line name names
  clang=$(apt-cache depends clang 2>/dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p' | head -n1)
  while read -r line; do
    IFS='| ' read -r -a names <<< "${line//\{clang\}/$clang}"
    for name in "${names[@]}"; do installed "$name" && continue 2; done
    for name in "${names[@]}"; do exists "$name" && echo "$name" && continue 2; done
    echo "${names[0]}"
  done < <(wanted)
}

command -v apt-get >/dev/null || {
  echo "setup.sh: apt-get is not there: this works on Debian and its relatives; elsewhere install what packages.txt" \
       "lists, then: cmake --preset $preset && cmake --build --preset $preset" >&2
  exit 1
}
if [ -n "$(missing)" ]; then
  sudo=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup.sh: packages are missing, and installing them needs root or sudo:" $(missing) >&2; exit 1; }
    sudo=sudo
  fi
  $sudo apt-get update -qq
  mapfile -t packages < <(missing)
  echo "== installing ${#packages[@]} packages and what they need (half a minute to two): ${packages[*]}"
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
fi

# Ninja's output, its steps as progress: one line that changes on a terminal, elsewhere a line every 10 s.
progress() {
  local line done total seconds last=-10 left
  while IFS= read -r line; do
    if [[ $line =~ ^@0/ ]]; then
      continue
    elif [[ $line =~ ^@([0-9]+)/([0-9]+)/([0-9]+) ]]; then
      done=${BASH_REMATCH[1]} total=${BASH_REMATCH[2]} seconds=${BASH_REMATCH[3]}
      left="about $(((total - done) * seconds / done)) s left"
      [ "$seconds" -ge 5 ] || left='...'
      if [ -t 1 ]; then
        printf '\r\033[K   %d of %d steps, %d s, %s' "$done" "$total" "$seconds" "$left"
        [ "$done" -lt "$total" ] || echo
      elif [ $((seconds - last)) -ge 10 ] || { [ "$done" -eq "$total" ] && [ "$last" -ge 0 ]; }; then
        last=$seconds
        printf '   %d of %d steps, %d s, %s\n' "$done" "$total" "$seconds" "$left"
      fi
    elif [ "$line" != 'ninja: no work to do.' ]; then
      printf '%s\n' "$line"
    fi
  done
}

echo "== building (preset $preset, in build/$preset)"
cmake --preset "$preset" ${options[@]+"${options[@]}"} >/dev/null
NINJA_STATUS='@%f/%t/%e ' cmake --build --preset "$preset" ${1:+--target "$@"} | progress
