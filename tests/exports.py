"""What is made once for all workers: the FMUs of the present sources, the compiled kernel."""

import importlib.util
import os
import pickle
import re
import zipfile
from concurrent.futures import ThreadPoolExecutor

from filelock import FileLock

from fmu_src.export import forms
from fmu_src.export.errors import CannotExport
from orchestrate.errors import InputError
from orchestrate.fmu.c_library import SOURCES, find_or_compile_library
from orchestrate.fmu.webassembly import find_or_compile_web_kernel
from tests import ROOT

BUILD = ROOT / "build"


def guid_inside(path):
    """The GUID that an FMU bears; None where there is none that can be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            text = archive.read("modelDescription.xml").decode()
    except (OSError, KeyError, zipfile.BadZipFile):
        return None
    return re.search(r'\b(?:guid|instantiationToken)="([^"]*)"', text)[1]


def refresh(build):
    """Export the FMUs that are missing or out of date.

    Returns
    -------
    dict of str to CannotExport
        What cannot be made here, as ``FORM/NAME``, and why.
    """
    build.mkdir(exist_ok=True)
    with FileLock(build / ".lock"), ThreadPoolExecutor() as threads:  # compilers work outside
        made = list(threads.map(lambda name: refresh_model(name, build), forms.MODELS))
        made += [refresh_library(source, build) for source in SOURCES]
    reasons = {place: reason for each in made for place, reason in each.items()}
    try:
        find_or_compile_web_kernel(build)
    except InputError as reason:
        reasons["wasm"] = CannotExport(str(reason))
    return reasons


def unexpected(reasons, build):
    """Those of the reasons that no missing package explains, or that leave an older FMU behind."""
    whole = all(map(importlib.util.find_spec, ("ziglang", "pythonfmu")))
    return {
        place: reason
        for place, reason in reasons.items()
        if whole or (build / f"{place}.fmu").exists()
    }


def refresh_model(name, build):
    """One model in all forms; returns as :func:`refresh`."""
    reasons = {}
    for form in forms.FORMS:
        if guid_inside(build / form / f"{name}.fmu") != forms.fmu_guid(name, form):
            try:
                forms.export(name, form, build)
            except CannotExport as reason:
                reasons[f"{form}/{name}"] = reason
    return reasons


def refresh_library(source, build):
    """The library of one loop; returns as :func:`refresh`."""
    try:
        find_or_compile_library(source, build)
    except InputError as reason:
        return {f"libraries/{source.stem}": reason}
    return {}


def once(tmp_path_factory, name, make):
    """What ``make()`` returns, called by the first worker of the session that comes here."""
    base = tmp_path_factory.getbasetemp()
    folder = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    kept = folder / f"{name}.pickle"
    with FileLock(folder / f"{name}.lock"):
        if not kept.exists():
            kept.write_bytes(pickle.dumps(make()))
        return pickle.loads(kept.read_bytes())
