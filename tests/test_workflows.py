"""Workflows run what was looked at: actions by commit, and locked files by their hashes."""

import re

import pytest

from tests import ROOT

GITHUB = ROOT / ".github"


@pytest.mark.parametrize("path", sorted((GITHUB / "workflows").glob("*.yml")), ids=lambda p: p.stem)
def test_actions_are_named_by_a_commit_and_its_tag(path):
    used = re.findall(r"uses: (.*)", path.read_text())
    assert used and all(re.fullmatch(r"[\w/-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", one) for one in used)


def test_a_release_installs_locked_files_and_attests_its_checksums():
    text = (GITHUB / "workflows" / "release.yml").read_text()
    own = "-e .", "dist/*.whl"  # what is built, and what a user would install with it
    for line in re.findall(r"pip install (.*)", text):
        assert "--require-hashes" in line or any(one in line for one in own), line
    assert "subject-checksums: dist/SHA256SUMS" in text
    for name in re.findall(r"-r (\S+\.txt)", text):
        locked = re.split(r"\n(?=\w)", (ROOT / name).read_text())[1:]
        assert len(locked) > 30 and all("==" in one and "--hash=sha256:" in one for one in locked)
