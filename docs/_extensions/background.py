"""What runs beside the reading of the pages: the examples of the gallery, the commands of the tutorials."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
POOL = ThreadPoolExecutor(2)  # programs at once; their threads only wait
