"""The report of the thesis' numerical studies: one HTML file with its figures in it."""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path

from cdia_pin.campaigns.scara_run import UNITS
from cdia_pin.campaigns.thesis_study import Case, Isolation, ThesisStudy
from cdia_pin.errors import CdiaError
from cdia_pin.viewers.study_figures import Picture
from cdia_pin.whole_files import write_whole

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{style}
figure {{ margin: 0; }}
figure img {{ width: 100%; height: auto; border-radius: 6px; background: #fff; display: block; }}
figcaption {{ color: var(--soft); font-size: 13px; margin-top: 8px; }}
</style>
</head>
<body>
<main>
<h1>{title}</h1>
{body}
</main>
</body>
</html>
"""


def write_study_report(
    path: str | Path, study: ThesisStudy, pictures: Sequence[Picture], command: str = ""
) -> Path:
    """Write what the studies measured as one HTML page that needs no network.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        study: The numbers.
        pictures: From `thesis_pictures`.
        command: What made the report, to be shown.

    Raises:
        CdiaError: If the file cannot be written.
    """
    path = Path(path)
    page = study_page(study, pictures, command)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, page)
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None
    return path


def study_page(study: ThesisStudy, pictures: Sequence[Picture], command: str = "") -> str:
    """Return the page.

    Args:
        study: The numbers.
        pictures: From `thesis_pictures`.
        command: The command that made the report.
    """
    body = [
        "<p class='lead'>Detection, accommodation and isolation of faults on the thesis' SCARA arm (Table 1, "
        "trajectory and control gains of its appendix), with the equations corrected. The arm moves by its "
        "closed form and a Runge–Kutta method at 1 kHz; the scheme knows it as a URDF through Pinocchio.</p>"
    ]
    if command:
        body.append(f"<pre><code>{html.escape(command)}</code></pre>")
    for name, cases in study.cases.items():
        preset = study.presets[name]
        body += [
            f"<h2>Preset {html.escape(name)}</h2>",
            f"<p>{html.escape(preset.about)}</p>",
            "<p class='soft'>RMS of q − q_d from two seconds after the last fault on.</p>",
            tracking_table(study, cases),
            *(f"<p><b>{html.escape(sentence)}</b></p>" for sentence in failures(study.joints, cases)),
            *figure_blocks(pictures, f"{name}_"),
        ]
    body += [
        "<h2>Isolation</h2>",
        "<p>Three effects are known: a gain of the actuators, Coulomb friction, a ripple in position; seven filters. "
        "A filter is excluded once its error leaves its threshold. As printed, the threshold and all parameters "
        "start at zero, and a true filter leaves it before it has learned. With time to learn, combinations that "
        "contain the true one fit as well, and so do some that lack a part of it.</p>",
        f"<p><b>{isolation_sentence(study.isolations)}</b></p>",
        isolation_table(study.isolations),
        *figure_blocks(pictures, "isolation_"),
    ]
    title = "The thesis' numerical studies"
    return PAGE.format(title=title, style=page_style(), body="\n".join(body))


def failures(joints: Sequence[str], cases: Iterable[Case]) -> list[str]:
    """Return a sentence for each case with joints whose faults were not accommodated.

    Args:
        joints: Names.
        cases: Of one preset.
    """
    sentences = []
    for case in cases:
        rms = case.tracking()
        found = [
            f"{joints[j]} ({rms['accommodated'][j]:.2g} against {rms['faulty'][j]:.2g} {UNITS[j]} without correction)"
            for j in case.worse
        ]
        if found:
            sentences.append(f"Not accommodated, {case.name}: {', '.join(found)}.")
    return sentences


def isolation_sentence(isolations: Iterable[Isolation]) -> str:
    """Return how many combinations were isolated under each rule.

    Args:
        isolations: Of all rules.
    """
    rules: dict[str, list[Isolation]] = {}
    for one in isolations:
        rules.setdefault(one.rule, []).append(one)
    return " ".join(
        f"{rule[:1].upper()}{rule[1:]}: {sum(i.isolated for i in every)} of {len(every)} combinations isolated, "
        f"in {sum(i.preferred and not i.isolated for i in every)} more the true one is the smallest survivor."
        for rule, every in rules.items()
    )


def tracking_table(study: ThesisStudy, cases: Iterable[Case]) -> str:
    """Return the RMS of the tracking error as an HTML table.

    Args:
        study: The numbers.
        cases: Of one preset.
    """
    headings = "".join(
        f"<th class='n'>{joint} [{unit}]</th>" for joint, unit in zip(study.joints, UNITS, strict=True)
    )
    rows = []
    for case in cases:
        found = case.detected_after
        detected = "not detected" if found is None else f"detected after {1e3 * found:.0f} ms"
        for i, (kind, rms) in enumerate(case.tracking().items()):
            first = (
                f"<b>{html.escape(case.name)}</b>"
                if i == 0
                else f"<span class='soft'>{detected}</span>" * (i == 1)
            )
            mark = {"faulty": " b", "accommodated": " a"}.get(kind, "")
            cells = "".join(f"<td class='n{mark}'>{value:.2g}</td>" for value in rms)
            rows.append(f"<tr><td>{first}</td><td>{kind}</td>{cells}</tr>")
    return (
        "<div class='card scroll'><table><thead><tr><th>fault</th><th>run</th>"
        f"{headings}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def isolation_table(isolations: Iterable[Isolation]) -> str:
    """Return the verdicts as an HTML table.

    Args:
        isolations: Of all rules.
    """
    rows = []
    for one in isolations:
        after = "" if one.after is None else f"{one.after:.3g} s"
        cells = (
            one.rule,
            " + ".join(one.true),
            one.verdict,
            " + ".join(one.first),
            f"{one.survivors} of 7",
            after,
        )
        texts = "".join(f"<td>{html.escape(c)}</td>" for c in cells)
        rows.append(f"<tr>{texts}</tr>")
    headings = ("rule", "faults present", "verdict", "smallest survivor", "survived", "after")
    head = "".join(f"<th>{h}</th>" for h in headings)
    return f"<div class='card scroll'><table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"


def figure_blocks(pictures: Iterable[Picture], stem: str = "") -> list[str]:
    """Return figures with their titles and captions as HTML.

    Args:
        pictures: All of them.
        stem: Beginning of the names of those that are returned.
    """
    return [
        f"<h3 style='margin-top:26px'>{html.escape(p.title)}</h3><figure class='card'>"
        f"<img alt='{html.escape(p.title)}' src='data:image/png;base64,{b64encode(p.png).decode()}'>"
        f"<figcaption>{html.escape(p.caption)}</figcaption></figure>"
        for p in pictures
        if p.name.startswith(stem)
    ]


def page_style() -> str:
    """Return the style of the package's reports: the last of their style sheets."""
    shell = (files("cdia_pin.viewers") / "assets" / "report.html").read_text(encoding="utf-8")
    return shell.rpartition("<style>")[2].partition("</style>")[0]
