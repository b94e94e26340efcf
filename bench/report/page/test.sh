#!/usr/bin/env bash
# Checks the page's sources, that report.html is made from them, and the page in Chromium; all in a copy of this folder:
#   test.sh COPY
# Says that it is skipped where Chromium, Node.js, numpy or the packages of package-lock.json are missing.
set -euo pipefail
cd "$(dirname "$0")"
for program in chromium node npm; do
  command -v $program >/dev/null || { echo "SKIPPED: $program is missing; ./setup.sh --for report installs it"; exit 0; }
done
/usr/bin/python3 -c 'import numpy' 2>/dev/null || { echo "SKIPPED: python3-numpy is missing"; exit 0; }
mkdir -p "$1"
cp -r ./* "$1"
cd "$1"
npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || { echo "SKIPPED: npm ci fails:"; tail -n 5 npm.log; exit 0; }
npm run --silent check
cp report.html committed.html
npm run --silent build
cmp report.html committed.html || { echo "report.html is not what npm run build makes of src/; commit what it makes"; exit 1; }
node --test test/report.test.mjs
