"""The commands as functions, and the way from files of other programs to a verdict."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas
import pytest
import voronudge


def test_a_fit_of_arrays_is_that_of_the_folder(fixtures):
    folder = fixtures / "chiral-liquid-clean"
    own = voronudge.infer(folder, quiet=True)
    arrays = voronudge.infer(
        positions=np.load(folder / "positions.npy"),
        velocities=np.load(folder / "velocities.npy"),
        box=(10, 10),
        quiet=True,
    )
    assert own.ok and abs(own["parameters"]["alpha"]["value"] - 3.4) < 1e-3
    assert own["parameters"]["alpha"]["value"] == pytest.approx(arrays["parameters"]["alpha"]["value"], rel=1e-3)
    table = pandas.DataFrame(own.rows("parameters")).set_index("name")
    assert table.loc["P_0", "value"] == own["parameters"]["P_0"]["value"]
    assert own.arrays["nudged_positions"].shape[-1] == 2
    assert "<iframe" in own._repr_html_()


def test_results_go_when_their_report_goes(fixtures, tmp_path):
    report = voronudge.observe(fixtures / "open-field", quiet=True)
    folder = report.folder
    kept = report.save(tmp_path / "kept")
    del report
    assert not folder.exists() and kept.to_dict()["command"]


def test_dicts_lists_and_flags_become_options(fixtures):
    report = voronudge.infer(fixtures / "chiral-liquid", fix={"K_A": 0.1}, bounds={"P_0": "3..5"}, stable=True, seed=4, quiet=True)
    assert report["parameters"]["K_A"]["value"] == pytest.approx(0.1)
    lattice = voronudge.spectrum(lattice=(6, 6), P_0=3.5, alpha=0.2, quiet=True)
    assert lattice.arrays["eigenvalues"].shape == (72, 2) or lattice.arrays["eigenvalues"].shape[-1] == 2


def test_faults_of_commands_are_exceptions(fixtures, tmp_path):
    with pytest.raises(voronudge.Error, match="nowhere") as caught:
        voronudge.infer(tmp_path / "nowhere", quiet=True)
    assert caught.value.hint and caught.value.exit_code == 2
    with pytest.raises(voronudge.Error, match="no option 'postions'") as caught:
        voronudge.infer(postions=np.eye(2))
    assert "positions" in caught.value.hint


def test_a_verdict_on_tracks_of_trackmate(fixtures):
    path = fixtures / "examples" / "tracks.xml"
    assert voronudge.info(path)["frame_interval"] == 5.0
    report = voronudge.verdict(path, quiet=True)
    # A tissue of the model and nothing else.
    assert (report["verdict"], report["selected"]) == ("nothing_missing", []), report["sentence"]
    assert report.page.stat().st_size > 10_000


def test_tracks_of_napari_are_those_of_trackmate(fixtures):
    examples = fixtures / "examples"
    known = {"pixel_size": 1.6, "length_unit": "um", "frame_interval": 5, "time_unit": "min"}
    own = voronudge.import_tracks(examples / "napari-tracks.csv", quiet=True, **known).arrays["positions"]
    other = voronudge.import_trackmate(examples / "tracks.xml", quiet=True).arrays["positions"]
    assert np.allclose(own, other, atol=0.02, equal_nan=True)


def test_cells_of_masks_are_where_the_tracks_have_them(fixtures):
    examples = fixtures / "examples"
    assert voronudge.info(examples / "masks.tif")["pixel_size"] == 1.6
    masks = voronudge.import_labels(examples / "masks.tif", link="overlap", positions="sites", quiet=True).arrays["positions"][0]
    tracks = voronudge.import_trackmate(examples / "tracks.xml", quiet=True).arrays["positions"][0]
    masks, tracks = (own[np.isfinite(own).all(axis=1)] for own in (masks, tracks))
    # Cells that the image cuts off are another matter; trackers err by .4 um.
    inner = tracks[(np.abs(tracks - 120) < 100).all(axis=1)]
    nearest = np.sqrt(((inner[:, None] - masks) ** 2).sum(axis=-1)).min(axis=1)
    assert len(inner) > 80 and np.sqrt((nearest**2).mean() / 2) < 0.6


def test_what_a_file_does_not_hold_is_said(fixtures):
    with pytest.raises(voronudge.Error, match="a fit needs at least"):
        voronudge.verdict(fixtures / "imports" / "trackmate-tracks.xml", quiet=True)


def test_the_program_runs_as_a_module():
    done = subprocess.run([sys.executable, "-m", "voronudge", "--version"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.split() == ["voronudge", voronudge.__version__]
    done = subprocess.run([sys.executable, "-m", "voronudge", "infer", "/nowhere"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.startswith("error: ")


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupt_ends_the_command_and_is_raised():
    code = (
        "import signal, voronudge\n"
        # Who starts tests in the background has them ignore it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    voronudge.simulate(cells=2000, time=10000, quiet=True)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, start_new_session=True)
    try:
        assert child.stdout.readline() == "begun\n"
        time.sleep(1.0)
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=30)
        assert out == "interrupted\n"
    finally:
        # The command, too, which is all of its group that may be left.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)


def test_every_command_is_a_function_with_help():
    for name in ["infer", "discover", "evaluate", "simulate", "spectrum", "moduli", "import_tracks", "import_labels"]:
        function = getattr(voronudge, name)
        assert name in voronudge.__all__ and "Parameters\n----------" in function.__doc__


def test_type_checkers_see_every_command():
    stub = (Path(voronudge.__file__).parent / "__init__.pyi").read_text()
    assert all(f"def {name}(" in stub or f" as {name}\n" in stub or f"{name}:" in stub for name in voronudge.__all__)
