"""``exoid identify``: an estimate from a leg and logs."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, NamedTuple

from typer import Option

import exoid
from exoid.errors import BadArgumentError
from exoid.tools.files import write_whole
from exoid.tools.toml import to_toml

from .column_map import columns_of
from .inputs import given_terms, read_drives, read_logs, refuse_other_payloads
from .legs import find_leg, refuse_unknown_leg, refuse_without_base
from .messages import status
from .numbers import parse_known, parse_prior, split_names
from .option_groups import expand_options
from .options import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    Cutoff,
    EstimateOutput,
    Figures,
    Known,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    Report,
    TermNames,
    Text,
    Texts,
)
from .outputs import check_outputs, print_result, save_page
from .refusals import refuse


class FitOptions(NamedTuple):
    """Options of the fit; texts are parsed by :meth:`settings`."""

    terms: TermNames = None
    estimator: Annotated[str, Option(help="wls, huber, ml or ols.")] = "wls"
    cutoff: Cutoff = None
    known: Known = None
    prior: Annotated[Texts, Option(metavar="NAME=VALUE:STD", help="Prior knowledge. Repeatable.")] = None
    nonnegative: Annotated[bool, Option("--nonnegative", help="Keep friction and rotor inertia at 0 or above.")] = False
    delay: Annotated[Text, Option(metavar="auto", help="auto: find by how much torques are late, and shift.")] = None
    check: Annotated[bool, Option("--check/--no-check", help="Look for faults of the logs.")] = True
    alike: Annotated[Text, Option(metavar="A,B", help="Limbs of one design, by how their joints' names begin.")] = None

    def settings(self) -> dict[str, Any]:
        """Parse the options."""
        if self.delay not in (None, "auto"):
            remedy = f"give --delay auto, or a delay that is known: --late JOINT={self.delay} [s]"
            raise BadArgumentError(f"--delay {self.delay}", remedy=remedy)
        return self._asdict() | {
            "terms": given_terms(self.terms),
            "known": parse_known(self.known),
            "prior": parse_prior(self.prior),
            "alike": split_names(self.alike) or (),
        }


@expand_options()
def identify(
    leg: LegName,
    logs: LogNames,
    output: EstimateOutput = None,
    choice: LegOptions = ANY_LEG,
    fit: FitOptions = FitOptions(),  # noqa: B008 - a tuple does not change
    own: Annotated[Text, Option(metavar="A,B", help="Parameters of each log (offset, c0_hip); others shared.")] = None,
    test: Annotated[Texts, Option(metavar="LOG", help="Predict a log that is not fitted. Repeatable.")] = None,
    report: Report = None,
    figures: Figures = None,
    reading: LogOptions = READ_AS_IT_IS,
    save_columns: Annotated[Text, Option(metavar="LAB.TOML", help="Write columns and options of these logs.")] = None,
    as_json: AsJson = False,
) -> None:
    """Identify the parameters of LEG from the LOGs: columns time, q_<joint>, tau_<joint>, optionally v_ and a_.

    A LOG may also be a folder of logs. Logs of currents (i_<joint>) need --actuators, see --help-log.

    Example: exoid identify bleex bleex_swing:train -o est.json
    """
    refuse_unknown_leg(leg)
    tests, pages = test or [], {"--test": test, "--report": report, "--figures": figures}
    refuse({} if own is None else pages, "with --own each log has an estimate")
    files = {"--output": output if own is None else None, "--report": report, "--save-columns": save_columns}
    check_outputs(files, [leg, *logs, *tests, reading.columns, reading.actuators], figures)
    from .folders import each_log, is_folder_of_logs, logs_on_disk  # noqa: PLC0415
    from .grouped import estimate_files, identify_grouped, log_names  # noqa: PLC0415 - help needs no logs

    on_disk = own is None and any(map(is_folder_of_logs, logs))
    logs = each_log(logs)
    refuse_other_payloads(reading, [*logs, *tests])
    if own is not None:
        paths = estimate_files(log_names(logs), output)
        check_outputs({f"--output of {name}": path for name, path in paths.items()}, [leg, *logs])
        text, data = identify_grouped(
            dict(zip(log_names(logs), read_logs(logs, reading), strict=True)),
            split_names(own) or (),
            lambda joints: find_leg(leg, choice, joints),
            lambda found: read_drives(reading, found),
            columns_of(reading),
            fit.settings(),
            paths,
        )
    else:
        recordings = logs_on_disk(logs, reading) if on_disk else read_logs(logs, reading, beside=tests)
        held_out = read_logs(tests, reading, beside=logs)
        settings, found = fit.settings(), find_leg(leg, choice, recordings[0].joint_names)
        refuse_without_base(choice, recordings)
        with status("identifying"):
            estimate = exoid.identify(found, recordings, actuators=read_drives(reading, found), **settings)
        estimate = replace(estimate, columns=columns_of(reading))
        predicted = [exoid.validate(estimate, recording) for recording in held_out]
        if output is not None:
            estimate.save(output)
        in_memory = (each for each in recordings if isinstance(each, exoid.Recording))
        save_page(lambda: exoid.view.report.identification_report(estimate, [*in_memory], held_out), figures, report)
        data = estimate.to_json()
        del data["leg"]["urdf"]
        if predicted:
            data["tests"] = [each.to_json() for each in predicted]
        text = "\n\n".join(map(str, [estimate, *predicted]))
    if save_columns is not None:
        write_whole(save_columns, [to_toml(columns_of(reading))])
    print_result(text, as_json=as_json, data=data)
