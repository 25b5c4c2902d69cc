"""A report in a real browser: wide and narrow, without a network, without a word on the console."""

import base64
import shutil
from pathlib import Path

import numpy as np
import pytest
from reported import report_and_runs

from rsmpm_ti.lab.report.page import PAGE, write_page
from rsmpm_ti.paint.movie import Movie

pytestmark = [pytest.mark.browser, pytest.mark.filterwarnings("ignore::rsmpm_ti.errors.RockWarning")]

WIDTHS = (390, 1280)
"""Of a phone and of a screen [px]."""

QUIET = (
    "headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run", "disable-background-networking",
    "disable-component-update", "disable-sync", "disable-dev-shm-usage",
)  # fmt: skip


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """Chromium with an empty profile; skips where it or selenium is missing."""
    selenium = pytest.importorskip("selenium.webdriver", reason="selenium is missing: pip install -e '.[browser]'")
    from selenium.webdriver.chrome.service import Service

    found = {name: shutil.which(name) for name in ("chromium", "chromedriver")}
    if missing := [name for name, path in found.items() if path is None]:
        pytest.skip(f"no {' and no '.join(missing)}: apt install chromium chromium-driver")
    options = selenium.ChromeOptions()
    options.binary_location = found["chromium"]
    for word in (*QUIET, f"user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(f"--{word}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = selenium.Chrome(options=options, service=Service(executable_path=found["chromedriver"]))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Path:
    """A report of a test of several specimens, with a movie."""
    out = tmp_path_factory.mktemp("report")
    report, measured = report_and_runs("triaxial", out, name="A rock of a rather long name, as they come")
    try:
        movie = Movie(measured[0][0].folder / "run.mp4")
        for shade in (255, 128, 0):
            movie.add(*(np.full((400, 800, 3), shade, dtype=np.uint8) for _ in range(2)))
        movie.close()
    except RuntimeError:  # no encoder: the page then says so
        pass
    write_page(out, report, measured)
    return out / PAGE


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", WIDTHS)
def test_report_is_whole_at_every_width(browser, page, tmp_path, width, scheme):
    size = {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    scheme = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", scheme)
    browser.get(page.as_uri())
    assert browser.execute_script("return window.innerWidth") == width
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    sizes = browser.execute_script("return [...document.images].map(i => [i.naturalWidth, i.clientWidth])")
    assert len(sizes) == 12 and all(natural > 0 and shown > 100 for natural, shown in sizes)
    drawn = browser.execute_script("return [...document.querySelectorAll('svg')].map(s => s.clientHeight)")
    assert len(drawn) >= 4 and min(drawn) > 150
    loaded = browser.execute_script("return performance.getEntriesByType('resource').map(e => e.name)")
    assert [name for name in loaded if not name.startswith("data:")] == []
    shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": True})
    (tmp_path / "report.png").write_bytes(base64.b64decode(shot["data"]))
    assert (tmp_path / "report.png").stat().st_size > 10_000
    said = [entry for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    assert said == []


def test_movie_plays_or_is_not_there(browser, page):
    browser.get(page.as_uri())
    if "<video" not in page.read_text(encoding="utf-8"):
        pytest.skip("no encoder, so no movie")
    ready = """
        const done = arguments[0], video = document.querySelector('video');
        if (video.readyState > 0) done(video.duration); else {
            video.addEventListener('loadedmetadata', () => done(video.duration));
            video.addEventListener('error', () => done(video.error.message));
        }
    """
    assert browser.execute_async_script(ready) > 0.0


def test_report_is_printed_without_its_movie(browser, page):
    browser.get(page.as_uri())
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": []})
    shown = browser.execute_script("return getComputedStyle(document.querySelector('#movie figure') || "
                                   "document.body).display")  # fmt: skip
    assert shown == ("none" if "<video" in page.read_text(encoding="utf-8") else "block")
    pdf = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {})["data"])
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})
    assert pdf.startswith(b"%PDF")
