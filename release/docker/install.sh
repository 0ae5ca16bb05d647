#!/bin/sh
# Installs SimWorlds from the files of `make dist` on a bare Debian or Ubuntu: install.sh DIST_FOLDER [PREFIX]
#
# With CPython 3.13 on x86-64 this includes Blender; elsewhere everything that needs none.
set -eu

dist=${1:?give the folder that make dist has written}
prefix=${2:-/opt/simworlds}
here=$(dirname "$0")
export DEBIAN_FRONTEND=noninteractive PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore

apt-get update -qq
if ! command -v python3 >/dev/null || ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
  apt-get install -qq -y --no-install-recommends python3 python3-venv >/dev/null
fi
apt-get install -qq -y --no-install-recommends ca-certificates bubblewrap $(cat "$here/debian-packages") >/dev/null

python3 -m venv "$prefix"
"$prefix/bin/pip" install --quiet --no-cache-dir --no-deps --require-hashes --requirement "$dist/requirements.txt"
"$prefix/bin/pip" install --quiet --no-cache-dir --no-deps "$dist"/simworlds-*.whl
ln -sf "$prefix/bin/simworlds" /usr/local/bin/simworlds
rm -rf /var/lib/apt/lists/*
simworlds --version
