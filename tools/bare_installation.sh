#!/bin/sh
# Install as somebody does who has neither a clone nor a compiler, and run README's first steps.
#
#     tools/bare_installation.sh [FOLDER]
#
# The sources as committed become an sdist, that a wheel, which is installed without extras into a
# new environment of FOLDER (by default a temporary one); the steps run with an empty PATH.
set -eux
root=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:-$(mktemp -d)}
mkdir -p "$folder/empty"
git clone -q "$root" "$folder/clone"

python3 -m venv "$folder/maker"
"$folder/maker/bin/pip" install -q build
"$folder/maker/bin/python" -m build --sdist --outdir "$folder/dist" "$folder/clone"
"$folder/maker/bin/pip" wheel -q --no-deps -w "$folder/dist" "$folder"/dist/*.tar.gz

python3 -m venv "$folder/user"
"$folder/user/bin/pip" install -q "$folder"/dist/*.whl

cp -r "$root/examples" "$root/README.md" "$folder/empty"
cp -r "$root/docs/records" "$folder/empty/records"
cd "$folder/empty"
python="$folder/user/bin/python"
PATH=/nowhere
export PATH
"$python" -c "import vibroimpact, orchestrate"
"$python" examples/time_history.py
"$python" -m orchestrate sweep --eta 1.1:1.3:0.05
"$python" -m orchestrate explore --no-open
"$python" -m orchestrate diagnose records/beam_a.csv --structure records/beam.toml
"$python" -m orchestrate build --folder build # copies what is in the wheel
"$python" - <<'EOF'
import re
from pathlib import Path

blocks = re.findall(r"```python\n(.*?)```", Path("README.md").read_text("utf-8"), re.S)
exec("\n".join(blocks))
EOF
code=0
"$python" -m orchestrate build --folder other --platforms all || code=$?
test $code = 2 # one line that says what is missing, no traceback
