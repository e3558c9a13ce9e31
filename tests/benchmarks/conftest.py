"""Figures mean nothing without the machine: ``pytest tests/benchmarks -s`` says first where it runs."""

import importlib.metadata
import os
import platform
from pathlib import Path

import numpy as np  # loads the BLAS that is asked for below
import pinocchio as pin
from threadpoolctl import threadpool_info

OTHERS = ("scipy", "mujoco", "figaroh")


def pytest_report_header() -> list[str]:
    """Processor, load, and what does the arithmetic."""
    blas = {
        f"{lib['internal_api']} {lib['version']} ({lib.get('architecture', '?')})"
        for lib in threadpool_info()
        if lib["user_api"] == "blas"
    }
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    return [
        f"machine: {processor()}, {os.cpu_count()} cores, load {load}",
        f"python {platform.python_version()}, numpy {np.__version__}, pinocchio {pin.__version__}, {', '.join(blas)}",
        ", ".join(f"{name} {version(name)}" for name in OTHERS),
    ]


def processor() -> str:
    """Model of the processor, as far as it says."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.is_file() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def version(package: str) -> str:
    """Of an installed package."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
