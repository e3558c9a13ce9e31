#!/usr/bin/env bash
# Run the quick tests with the oldest versions of all direct dependencies that pyproject.toml admits.
# Needs uv (pip install uv) and Python 3.10 (or $PYTHON). Arguments replace the tests to run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
uv venv --quiet --python "${PYTHON:-3.10}" "$folder/venv"
VIRTUAL_ENV="$folder/venv" uv pip install --quiet --resolution lowest-direct '.[test]'
export PATH="$folder/venv/bin:$PATH" PYTHONPYCACHEPREFIX="$folder/pyc" OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
unset PYTHONPATH PYTHONHOME
cd "$folder" && cp -r "$OLDPWD"/{tests,scripts,pyproject.toml} . # against the wheel that was installed
if [[ $# -eq 0 ]]; then
    set -- tests/torques tests/signals tests/cli tests/regression tests/estimate tests/identification tests/leg/test_leg.py tests/leg/test_description.py
fi
pytest -p no:cacheprovider -q -m 'not slow and not real_data' "$@"
