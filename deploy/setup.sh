#!/usr/bin/env bash
# Installs the Debian packages that Couplet is built from and runs with. Says what is missing before it installs it;
# silent and quick when nothing is.
#   deploy/setup.sh           install what is missing
#   deploy/setup.sh --list    print all packages, one a line
set -euo pipefail

packages=(
  # to build
  g++ cmake ninja-build git pkg-config
  # libraries
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libeigen3-dev libspectra-dev libsuitesparse-dev libopenblas-serial-dev
  cppzmq-dev libprotobuf-dev protobuf-compiler libcli11-dev nlohmann-json3-dev libmuparser-dev
  libassimp-dev
  # reports, studies and validation cases
  python3 python3-numpy python3-matplotlib python3-h5py python3-meshio
  # programs of one's own that take part in a run; crc32c: the checksum of arrays, in hardware where there is some
  python3-zmq python3-protobuf python3-crc32c
  # tests and checks
  libgtest-dev libgmock-dev clang-format hdf5-tools
)

fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }

case "${1:-}" in
  "") ;;
  --list) printf '%s\n' "${packages[@]}"; exit 0 ;;
  *) printf 'setup: unknown argument %s; there is only --list\n' "$1" >&2; exit 2 ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this is not a Debian system; install what corresponds to 'deploy/setup.sh --list' by hand and set COUPLET_SKIP_SETUP=1"
fi

installed=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null |
  awk '$2 == "installed" { print $1 }' || true)
missing=()
for package in "${packages[@]}"; do
  grep --quiet --line-regexp --fixed-strings -- "$package" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

printf 'setup: these Debian packages are missing and will be installed, with what they depend on:\n' >&2
printf '  %s\n' "${missing[*]}" | fold --spaces --width=110 >&2
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    fail "installing needs root, and there is no sudo here; ask an administrator for: apt-get install --no-install-recommends ${missing[*]}"
  sudo -n true 2>/dev/null || [ -t 0 ] ||
    fail "installing needs root, and sudo would ask for a password; run 'sudo deploy/setup.sh' first"
  as_root=(sudo)
fi

log=$(mktemp -t couplet-setup-XXXXXX.log)
root() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "$@" >>"$log" 2>&1; }
known() { LC_ALL=C apt-cache policy "$1" 2>/dev/null | awk '/Candidate:/ && $2 != "(none)" { found = 1 } END { exit !found }'; }
install_missing() { root apt-get install --yes --no-install-recommends "${missing[@]}"; }
failed() {
  printf '  %s\n' "$(tail -n 12 "$log")" >&2
  fail "$1; the whole output is in $log"
}

# The lists of packages are fetched only when they do not know a package, or are too old to fetch it.
fetch_lists() { root apt-get update || failed "apt-get update failed: is there a network, and are the Debian sources right?"; }
fetched=no
for package in "${missing[@]}"; do
  known "$package" || { fetch_lists; fetched=yes; break; }
done
for package in "${missing[@]}"; do
  known "$package" || fail "Debian does not offer $package here; Couplet needs Debian 12 or newer"
done
if ! install_missing; then
  [ "$fetched" = no ] || failed "apt-get install failed"
  fetch_lists
  install_missing || failed "apt-get install failed"
fi
rm -f "$log"
printf 'setup: installed\n' >&2
