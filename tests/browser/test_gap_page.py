"""The page of a diagnosis, operated in a browser: zoom, sliders, switches, colours, and the page without a script."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.reports.html_report import write_html_report
from labsid.gap.reports.quantities import number, with_units
from labsid.gap.reports.result import Diagnosis
from labsid.records.record import Record

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Locator, Page

TS, SAMPLES, LIMIT = 0.5, 500, 3.1
MOST_BYTES = 1_500_000
RANGES = """() => Object.fromEntries([...Bokeh.documents[0].roots()[0].references()]
    .filter((model) => model.type === "Figure").map((model) => [model.name,
        [model.x_range.start, model.x_range.end, model.y_range.start, model.y_range.end]]))"""
SIGNALS = """() => Object.fromEntries(Object.entries([...Bokeh.documents[0].roots()[0].references()]
    .find((model) => model.name === "record").data).map(([name, values]) => [name, Array.from(values)]))"""

COLOUR = "[...Bokeh.documents[0].roots()[0].references()].find((one) => one.name === 'after').glyph.line_color"


def lags(x: np.ndarray) -> np.ndarray:
    """Two lags in a row."""
    return np.asarray(lfilter([0.0, 0.01], np.poly([0.95, 0.8]), x))


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """The diagnosis of a rig whose actuator has a limit, by a search for few effects."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(1.0, 4.0, SAMPLES // 25), 25)
    w = np.minimum(u, LIMIT)
    y = w[0] + lags(w - w[0]) + 0.005 * rng.standard_normal(SAMPLES)
    with searched("input-saturation", "input-nonlinearity", "output-saturation"):
        return diagnose(Record(TS * np.arange(SAMPLES), u, y, TS, name="limited"))


@pytest.fixture(scope="module")
def path(found: Diagnosis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its page, in volts and millimetres."""
    written = tmp_path_factory.mktemp("page") / "page.html"
    write_html_report(written, with_units(found.report, "V", "mm"))
    return written


@pytest.fixture
def page(context: "BrowserContext", path: Path) -> "Iterator[Page]":
    """The page, its panels drawn. Nothing may be refused or fail on it."""
    opened = context.new_page()
    failures: list[str] = []
    opened.on("pageerror", lambda failure: failures.append(str(failure)))
    opened.on("console", lambda message: failures.append(message.text) if message.type == "error" else None)
    opened.goto(path.as_uri())
    opened.locator(".still").first.wait_for(state="hidden")
    yield opened
    opened.close()
    assert failures == []


@pytest.fixture
def error(page: "Page") -> Callable[[], str]:
    """The rms error on the scored samples that the page shows."""
    return lambda: page.locator("#rms dd").first.inner_text()


def slider(page: "Page") -> "Locator":
    """The slider of the only parameter."""
    return page.get_by_role("slider", name="Upper limit")


def test_the_panels_show_the_exported_simulation(page: "Page", found: Diagnosis) -> None:
    shown = page.evaluate(SIGNALS)
    record = found.report["replay"]["record"]
    assert shown["t"] == pytest.approx(record["start"] + TS * np.arange(SAMPLES))
    theta, model = found.model.theta, found.model
    output = model.hypothesis.output(theta, model.gains, model.u_scale.of(np.array(shown["u"])))
    assert shown["after"] == pytest.approx(np.asarray(model.y_scale.back(output)), abs=1e-6 * np.ptp(shown["y"]))
    assert shown["e_after"] == pytest.approx(np.subtract(shown["y"], shown["after"]), abs=1e-9)


def test_a_drag_zooms_all_panels_in_time_and_a_double_click_resets(page: "Page") -> None:
    panels = page.locator("#panels-record")
    panels.scroll_into_view_if_needed()
    box = panels.bounding_box()
    assert box is not None
    whole = page.evaluate(RANGES)
    assert [whole[name][:2] for name in ("output", "error", "input")] == [[0.0, TS * (SAMPLES - 1)]] * 3
    page.mouse.move(box["x"] + 300, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 500, box["y"] + 200, steps=5)
    page.mouse.up()
    zoomed = page.evaluate(RANGES)
    start, end = zoomed["output"][:2]
    assert 0.0 < start < end < TS * (SAMPLES - 1)
    assert all(zoomed[name][:2] == [start, end] for name in ("error", "input"))
    page.mouse.dblclick(box["x"] + 400, box["y"] + 150)
    assert page.evaluate(RANGES) == pytest.approx({name: pytest.approx(ends) for name, ends in whole.items()})


def test_keys_move_and_zoom_the_panel_that_has_the_focus(page: "Page") -> None:
    whole = page.evaluate(RANGES)["output"][:2]
    page.keyboard.press("ArrowRight")  # nothing has the focus
    page.locator(".bk-events").nth(1).focus()
    page.keyboard.press("+")
    near = page.evaluate(RANGES)["output"][:2]
    assert near[1] - near[0] == pytest.approx(0.8 * (whole[1] - whole[0]))
    page.keyboard.press("ArrowRight")
    moved = page.evaluate(RANGES)
    assert moved["input"][:2] == pytest.approx(
        [near[0] + 0.1 * (near[1] - near[0]), near[1] + 0.1 * (near[1] - near[0])]
    )
    for _ in range(9):
        page.keyboard.press("ArrowRight")
    assert page.evaluate(RANGES)["error"][1] == pytest.approx(whole[1])
    page.keyboard.press("0")
    assert page.evaluate(RANGES)["output"][:2] == pytest.approx(whole)


def test_the_worst_stretch_is_shown_with_the_heights_of_its_samples(page: "Page", found: Diagnosis) -> None:
    whole, signals = page.evaluate(RANGES), page.evaluate(SIGNALS)
    page.get_by_role("button", name="Worst stretch").click()
    shown = page.evaluate(RANGES)
    start, end = shown["output"][:2]
    t, error = np.array(signals["t"]), np.abs(signals["e_before"])
    inside = (t >= start) & (t <= end)
    assert np.mean(error[inside] ** 2) > 2.0 * np.mean(error**2)
    curves = np.array([signals[name] for name in ("y", "before", "after")])[:, inside]
    low, high = shown["output"][2:]
    assert low < curves.min() < low + 0.1 * (high - low)
    assert high - 0.1 * (high - low) < curves.max() < high
    assert shown["output"][2:] != whole["output"][2:]


def test_on_paper_there_is_the_figure_and_no_controls(page: "Page") -> None:
    page.emulate_media(media="print")
    assert page.locator(".still img").first.is_visible()
    assert not page.locator(".live").first.is_visible()
    assert page.locator(".glance img").is_visible()
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details:not([open])").count() == 0


def test_the_pointer_gets_the_values(page: "Page") -> None:
    panels = page.locator("#panels-record")
    panels.scroll_into_view_if_needed()
    box = panels.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 400, box["y"] + 150, steps=2)
    for word in ("Time", "Measured", "Before", "After"):
        page.locator(".bk-Tooltip span", has_text=word).first.wait_for(state="visible")


def test_a_slider_replays_the_simulation(page: "Page", error: Callable[[], str], found: Diagnosis) -> None:
    fitted, at_first = error(), page.evaluate(SIGNALS)
    assert fitted == f"{number(found.report['gap']['after'])} mm"
    assert page.locator(".slider output").inner_text().endswith(" V")
    slider(page).focus()
    for _ in range(5):
        page.keyboard.press("ArrowLeft")
    moved = page.evaluate(SIGNALS)
    assert float(error().split()[0]) > 2.0 * float(fitted.split()[0])
    assert "changed by hand" in page.locator("#state").inner_text()
    limit = float(page.locator(".slider output").inner_text().split()[0])
    assert slider(page).get_attribute("aria-valuetext") == page.locator(".slider output").inner_text()
    model = found.model
    theta = model.theta.copy()
    theta[model.hypothesis.slices["input-saturation/high"]] = model.u_scale.of(np.array([limit]))
    output = model.hypothesis.output(theta, model.gains, model.u_scale.of(np.array(moved["u"])))
    assert moved["after"] == pytest.approx(np.asarray(model.y_scale.back(output)), abs=1e-3 * np.ptp(moved["y"]))
    page.get_by_role("button", name="Back to the fitted values").click()
    assert error() == fitted
    assert page.evaluate(SIGNALS)["after"] == at_first["after"]


def test_effects_are_switched_on_and_off(page: "Page", error: Callable[[], str], found: Diagnosis) -> None:
    fitted = error()
    ours = page.get_by_role("checkbox", name="Limit of the actuator", exact=True)
    assert ours.is_checked()
    assert "closes" in page.locator("#state").inner_text()
    ours.uncheck()
    assert page.locator("#state").inner_text().startswith("The simulation before.")
    assert error() == f"{number(found.report['gap']['before'])} mm"
    assert slider(page).count() == 0
    other = page.get_by_role("checkbox").nth(1)
    other.check()
    assert not ours.is_checked()
    assert error() not in (fitted, f"{number(found.report['gap']['before'])} mm")
    ours.check()
    assert error() == fitted


def test_the_page_meets_axe_core_and_fits_a_telephone(page: "Page", path: Path) -> None:
    from browser.accessibility import problems_in_either_scheme

    assert problems_in_either_scheme(page, "gap-replay") == []
    assert path.stat().st_size < MOST_BYTES


def test_the_panels_follow_the_colours_of_the_page(page: "Page") -> None:
    colours = []
    for scheme in ("light", "dark", "light"):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_timeout(300)  # milliseconds, until the page has been drawn
        colours.append(page.evaluate(f"{COLOUR}.value"))
    assert colours[0] == colours[2] != colours[1]


@pytest.mark.parametrize("width", [320, 390])
def test_nothing_is_wider_than_a_telephone_with_everything_unfolded(page: "Page", width: int) -> None:
    page.set_viewport_size({"width": width, "height": 800})
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.wait_for_timeout(300)  # milliseconds, until the page has been drawn
    beyond = """(width) => [...document.querySelectorAll("main *")]
        .filter((one) => one.getBoundingClientRect().right > width).length"""
    assert page.evaluate(beyond, width) == 0


def test_without_a_script_it_is_the_page_with_a_figure(browser: Any, path: Path) -> None:
    window = browser.new_context(java_script_enabled=False)
    page = window.new_page()
    page.goto(path.as_uri())
    assert page.locator(".still img").is_visible()
    assert not page.locator(".live").first.is_visible()
    window.close()


def test_a_finger_scrolls_the_page_over_the_panels(browser: Any, path: Path) -> None:
    window = browser.new_context(viewport={"width": 390, "height": 800}, has_touch=True, is_mobile=True)
    page = window.new_page()
    page.goto(path.as_uri())
    page.locator(".still").first.wait_for(state="hidden")
    action = """() => { const found = [];
        const search = (root) => root.querySelectorAll("*").forEach((node) => {
            if (node.classList.contains("bk-events")) found.push(getComputedStyle(node).touchAction);
            if (node.shadowRoot) search(node.shadowRoot); });
        search(document); return found; }"""
    assert set(page.evaluate(action)) == {"auto"}
    window.close()


def test_ten_times_as_many_samples_fit_the_page(found: Diagnosis, tmp_path: Path) -> None:
    """Its size for 5,000 samples: the signals of the page and the traces of the figures, ten times as long."""
    report = dict(found.report)
    record = report["replay"]["record"]
    longer = {name: record[name] * 10 for name in ("u", "y", "before", "after")}
    traces = {name: values * 5 for name, values in report["traces"].items()}
    report |= {"replay": report["replay"] | {"record": record | longer}, "traces": traces}
    write_html_report(tmp_path / "page.html", report)
    assert (tmp_path / "page.html").stat().st_size < MOST_BYTES


def test_each_of_several_records_is_shown_in_its_own_time(context: "BrowserContext", tmp_path: Path) -> None:
    from browser.accessibility import problems_in_either_scheme

    rng = np.random.default_rng(5)
    runs = []
    for name, samples, noise in (("first", 400, 0.005), ("<b>second</b>", 500, 0.005)):
        u = np.repeat(rng.uniform(1.0, 4.0, samples // 25), 25)
        w = np.minimum(u, LIMIT)
        y = w[0] + lags(w - w[0]) + noise * rng.standard_normal(samples)
        runs.append(Record(TS * np.arange(samples), u, y, TS, name=name))
    with searched("input-saturation"):
        report = diagnose(runs).report
    write_html_report(tmp_path / "page.html", report)
    page = context.new_page()
    failures: list[str] = []
    page.on("pageerror", lambda failure: failures.append(str(failure)))
    page.goto((tmp_path / "page.html").as_uri())
    choice = page.locator("#piece")
    choice.wait_for(state="visible")
    page.locator("#rms dd").first.wait_for(state="visible")
    assert choice.locator("option").all_inner_texts() == ["first", "<b>second</b>"]
    for label, run in zip(("first", "<b>second</b>"), runs, strict=True):
        choice.select_option(label=label)
        left, right, *_ = page.evaluate(RANGES)["output"]
        assert (left, right) == pytest.approx((0.0, run.t[-1]))
        signals = page.evaluate(SIGNALS)
        np.testing.assert_allclose(signals["t"], run.t, atol=1e-9)
        np.testing.assert_allclose(signals["y"], run.y, atol=1e-3)
    choice.select_option(
        label="first" if report["records"][1]["before"] > report["records"][0]["before"] else "<b>second</b>"
    )
    page.get_by_role("button", name="Worst stretch").click()
    left, right, *_ = page.evaluate(RANGES)["output"]
    worst = runs[int(choice.input_value())]
    assert 0.0 <= left < right <= worst.t[-1]
    assert right - left < 0.5 * worst.t[-1]
    found = problems_in_either_scheme(page, "gap-several")
    page.close()
    assert failures == []
    assert not found, "\n".join(found)


def test_a_notebook_shows_the_same_page(context: "BrowserContext", found: Diagnosis) -> None:
    """In a frame whose scripts have no access to the notebook."""
    page = context.new_page()
    page.set_content(f"<!doctype html><title>Notebook</title>{found._repr_html_()}")
    frame = page.frame_locator("iframe")
    frame.get_by_role("slider", name="Upper limit").wait_for(state="visible")
    assert frame.locator("#rms dd").first.inner_text() == number(found.report["gap"]["after"])
    page.close()
