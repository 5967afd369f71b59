"""The runs of a campaign in a folder: Parquet files that are written while it goes on."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

from cdia_pin import schemas
from cdia_pin.campaigns.campaign_spec import CampaignError, CampaignSpec, FaultCase
from cdia_pin.campaigns.run_row import RunRow, row_from_dict, row_schema, row_to_dict
from cdia_pin.input_files import read_text
from cdia_pin.version import __version__
from cdia_pin.whole_files import whole_file, write_whole

PLAN, RUNS = "campaign.json", "runs"
CAMPAIGN, TUNING = "campaign", "tuning"  # purposes
WRITE_EVERY = 15.0  # [s], what a loss of power costs at most; each time makes one file
MOST_ROWS = 10_000  # rows that wait to be written


@dataclass
class RunStore:
    """A folder of runs: ``campaign.json`` and ``runs/*.parquet``.

    Attributes:
        folder: The folder.
        spec: The plan of its campaign.
        purpose: ``campaign`` or ``tuning``: what its runs were made for.
    """

    folder: Path
    spec: CampaignSpec
    purpose: str = CAMPAIGN
    _waiting: list[RunRow] = field(default_factory=list, repr=False)
    _written: float = field(default_factory=monotonic, repr=False)

    @classmethod
    def made(cls, folder: str | Path, spec: CampaignSpec, purpose: str = CAMPAIGN) -> RunStore:
        """Return the folder of a campaign; a new one is made, and that of the same plan goes on.

        Args:
            folder: The folder.
            spec: The plan.
            purpose: What its runs are made for.

        Raises:
            CampaignError: If it holds another campaign, or runs of another version of the package.
            OSError: If it cannot be made.
        """
        folder = Path(folder)
        if (folder / PLAN).exists():
            found = cls.opened(folder, purpose)
            if found.spec != spec:
                raise CampaignError(
                    f"{folder} holds the runs of another campaign: give another folder to --out"
                )
            return found
        (folder / RUNS).mkdir(parents=True, exist_ok=True)
        document = {
            "schema": schemas.CAMPAIGN_PLAN,
            "version": __version__,
            "purpose": purpose,
            "spec": asdict(spec),
        }
        write_whole(folder / PLAN, json.dumps(document, indent=2, ensure_ascii=False) + "\n")
        return cls(folder, spec, purpose)

    @classmethod
    def opened(cls, folder: str | Path, purpose: str = CAMPAIGN) -> RunStore:
        """Return the folder of a campaign that has been run.

        Args:
            folder: The folder.
            purpose: What its runs must have been made for.

        Raises:
            CampaignError: If it holds none, or one of another version of the package.
        """
        folder = Path(folder)
        try:
            document = json.loads(read_text(folder / PLAN))
            schema, version, given = document["schema"], document["version"], document["spec"]
            made_for = document["purpose"]
            spec = _spec_from_json(given) if schema == schemas.CAMPAIGN_PLAN else None
        except OSError as error:
            raise CampaignError(f"{folder} holds no campaign: {PLAN}: {error.strerror}") from None
        except (ValueError, KeyError, TypeError) as error:
            raise CampaignError(f"{folder} holds no campaign: {error}") from None
        if spec is None:
            raise CampaignError(f"{folder / PLAN} has the schema {schema}, expected {schemas.CAMPAIGN_PLAN}")
        if version != __version__:
            raise CampaignError(
                f"{folder} was made by cdia-pin {version}, and this is {__version__}: runs of two versions do not "
                "add up"
            )
        if made_for != purpose:
            raise CampaignError(f"{folder} holds the runs of a {made_for}, expected those of a {purpose}")
        return cls(folder, spec, purpose)

    def read(self) -> dict[int, RunRow]:
        """Return the runs by number; of a run that was made again, the last."""
        import pyarrow.parquet as pq

        out: dict[int, RunRow] = {}
        for file in sorted((self.folder / RUNS).glob("*.parquet")):
            for row in pq.read_table(file).to_pylist():
                out[row["number"]] = row_from_dict(row)
        return dict(sorted(out.items()))

    @contextmanager
    def writing(self) -> Iterator[RunStore]:
        """Write what waits when the block ends, however it ends."""
        try:
            yield self
        finally:
            self._write()

    def add(self, rows: Iterable[RunRow]) -> None:
        """Take rows, which reach the folder within `WRITE_EVERY` or at the end of the block.

        Args:
            rows: Of new runs.
        """
        self._waiting += rows
        if monotonic() - self._written >= WRITE_EVERY or len(self._waiting) >= MOST_ROWS:
            self._write()

    def _write(self) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        self._written = monotonic()
        if not self._waiting:
            return
        about = {"schema": schemas.CAMPAIGN_RUNS, "version": __version__, "campaign": self.spec.digest}
        schema = row_schema().with_metadata(about)
        table = pa.Table.from_pylist([row_to_dict(r) for r in self._waiting], schema=schema)
        last = max((int(f.stem) for f in (self.folder / RUNS).glob("*.parquet")), default=0)
        with whole_file(self.folder / RUNS / f"{last + 1:06d}.parquet") as file:
            pq.write_table(table, file)
        self._waiting.clear()


def _spec_from_json(given: dict[str, Any]) -> CampaignSpec:
    """Read back the plan that `RunStore.made` wrote."""
    faults = tuple(FaultCase(tuple(f["terms"]), tuple(f["shares"])) for f in given["faults"])
    settings = tuple((name, tuple(values)) for name, values in given["settings"])
    lists = {k: tuple(v) for k, v in given.items() if isinstance(v, list)}
    return CampaignSpec(**{**given, **lists, "faults": faults, "settings": settings})
