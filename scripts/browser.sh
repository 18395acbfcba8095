#!/bin/sh
# Sees to a Chromium for the tests: one on this machine, else the system's package, else Playwright's own.
# Usage: browser.sh PYTHON
set -eu

# A browser that is only a stub (Ubuntu's package points to a snap) does not answer.
browser() {
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        "$name" --version >/dev/null 2>&1 && command -v "$name" && return
    done
    return 1
}

browser && exit
if [ "$(id -u)" = 0 ]; then
    if command -v apt-get >/dev/null; then
        apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends chromium
    elif command -v dnf >/dev/null; then
        dnf install --assumeyes chromium
    elif command -v apk >/dev/null; then
        apk add chromium
    fi || echo "The system has no Chromium package: taking Playwright's."
    browser && exit
fi
"$1" -m playwright install chromium
