# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The page of `eti-review report` in a browser: its content, its interaction, and that it makes no network requests.
Its sessions are the runs of operator_run.py."""

import base64
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

import support
from operator_run import recording

HOSTILE = '</script><script>document.title="taken"</script><img src="http://192.0.2.1/x" onerror="document.title=\'taken\'">'
SHOTS = os.environ.get("ETI_REPORT_PICTURES")  # a folder for screenshots, for people to look at


def setUpModule():
    if shutil.which("chromium") is None or shutil.which("chromedriver") is None:
        raise unittest.SkipTest("no chromium or chromium-driver")


@functools.cache
def folder():
    made = tempfile.TemporaryDirectory(prefix="eti-report-")
    unittest.addModuleCleanup(made.cleanup)
    return Path(made.name)


@functools.cache
def killed():
    """A recording that ended by SIGKILL during the attempt."""
    file = folder() / "killed.eti.h5"
    process = subprocess.Popen([support.BIN / "eti-server", "--scenario", "term", "--operator", "expert", "--fast",
                                "--no-dds", "--record", file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + 300
    while time.monotonic() < end:
        done = support.run("eti-review", "summary", file, "--json")
        if done.returncode == 0 and json.loads(done.stdout)["duration_s"] > 3:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGKILL)
    process.wait()
    return file


class Report(support.Case):
    def page(self, *files, width=1200):
        """The report about these files in a browser that records its requests and errors."""
        done = support.run("eti-review", "report", *files, "--out", self.folder, timeout=120)
        if "was built without the page" in done.stderr:
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.file = self.folder / "report.html"
        self.assertEqual(done.stdout.strip(), str(self.file))
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for option in ("headless=new", "no-sandbox", "disable-dev-shm-usage", "use-gl=angle",
                       "use-angle=swiftshader", "enable-unsafe-swiftshader", f"window-size={width},900",
                       f"user-data-dir={self.folder / 'profile'}"):
            options.add_argument(f"--{option}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.browser = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.addCleanup(self.browser.quit)
        # What is drawn on canvases, such as the labels of axes, is no text of the page.
        self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": """
            window.drawnTexts = [];
            const fillText = CanvasRenderingContext2D.prototype.fillText;
            CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
              window.drawnTexts.push(text);
              return fillText.call(this, text, ...rest);
            };"""})
        self.browser.get(self.file.as_uri())
        WebDriverWait(self.browser, 120).until(lambda _: self.find("#anatomy[data-ready]"))

    def find(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def text(self, selector):
        return " ".join(one.text for one in self.find(selector))

    def keep(self, name):
        """Saves the window's content as a picture."""
        file = Path(SHOTS or self.folder) / f"{name}.png"
        self.browser.save_screenshot(str(file))
        return file

    def assert_quiet(self):
        """No error in its console, and no network request."""
        self.assertEqual([one for one in self.browser.get_log("browser") if one["level"] == "SEVERE"], [])
        messages = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        asked = [message["params"]["request"]["url"] for message in messages
                 if message["method"] == "Network.requestWillBeSent"
                 and message["params"]["documentURL"] == self.file.as_uri()]  # the browser's own first page makes requests, too
        self.assertIn(self.file.as_uri(), asked)
        for address in asked:
            self.assertRegex(address, r"^(file|data|blob):")

    def stage(self):
        self.find("#anatomy .stage")[0].location_once_scrolled_into_view
        return self.find(".stage canvas")[0].screenshot_as_png

    def stage_at(self, share):
        """The stage once it is steady after the slider was moved."""
        self.set_slider(share)
        seen = [self.stage()]

        def rests():
            time.sleep(0.2)
            seen.append(self.stage())
            return seen[-1] == seen[-2]
        support.wait_until(rests, "two equal pictures of the stage")
        return seen[-1]

    def set_slider(self, share):
        self.browser.execute_script(
            "const s = document.querySelector('#anatomy input[type=range]'); s.value = s.max * arguments[0];"
            "s.dispatchEvent(new Event('input'));", share)

    def assert_numbers(self, shown, file):
        """Each cell of a column equals the summary."""
        summary = json.loads(support.run("eti-review", "summary", file, "--json").stdout)
        count = 0
        for key, (value, text) in shown.items():
            expected = summary["parameters"]
            for part in key.split("."):
                expected = expected[part]
            if expected is None:
                self.assertEqual((value, text[0]), ("null", "–"), key)
            else:
                self.assertEqual(float(value), expected, key)
                self.assertAlmostEqual(float(text.split()[0]), expected, delta=0.005 + 1e-9, msg=key)
            count += 1
        flat = sum(len(one) if isinstance(one, dict) else 1 for one in summary["parameters"].values())
        self.assertEqual(count, flat)
        return summary

    def cells(self, column=0):
        return {cell.get_attribute("data-key"): (cell.get_attribute("data-value"), cell.text)
                for cell in self.find(f"#parameters td[data-column='{column}']")}

    def test_report_compares_expert_and_novice(self):
        expert, novice = recording("expert"), recording("novice")
        self.page(expert, novice)
        summary = self.assert_numbers(self.cells(), expert)
        self.assertEqual(self.text("#outcome .outcome"), "Intubated Not intubated")
        # One reason, with one depth, for each attempt: the run's is the last attempt's.
        first = self.find("#outcome .columns > div")[0].text
        self.assertEqual(len(summary["attempts"]), 1)
        self.assertEqual(first.count(summary["attempts"][0]["reason"]), 1)
        self.assertEqual(len(re.findall("past the glottis", first)), 1, first)
        # Each chart's axis begins at 0 s, though the first sample is later.
        labels = self.browser.execute_script("return window.drawnTexts")
        self.assertGreaterEqual(labels.count("0 s"), len(self.find(".uplot")))
        self.assertIn("to the first", self.text("#parameters td[data-column='1']"))
        # The legend switches a session's line in every chart.
        legend = self.find(".uplot .u-legend .u-series:nth-child(3) th")[0]
        self.assertEqual(self.find(".u-series.u-off"), [])
        legend.click()
        self.assertGreaterEqual(len(self.find(".u-series.u-off")), 1)
        legend.click()
        self.assertEqual(self.find(".u-series.u-off"), [])
        # The slider moves tools and tissue.
        before = self.stage_at(0.1)
        self.set_slider(0.6)
        support.wait_until(lambda: self.stage() != before, "another picture of the stage")
        self.assertEqual(len(self.find("#anatomy .gallery img")), 3)
        self.assert_quiet()
        self.assertLess(self.file.stat().st_size, 2 * 15e6)
        self.browser.execute_script("scrollTo(0, 0)")

        def is_painted():
            with Image.open(self.keep("desktop")) as picture:
                return numpy.asarray(picture.convert("L")).std() > 10

        support.wait_until(is_painted, "the page's picture")

    def tap(self, element):
        """A touch, as on a phone."""
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        box = self.browser.execute_script("const b = arguments[0].getBoundingClientRect(); return [b.x, b.y];", element)
        point = {"x": box[0] + 5, "y": box[1] + 5}
        self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
        self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [point]})
        self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})

    def assert_headings_stay_with_their_content(self):
        """On paper no heading, introduction or head of a table is the last of a page, and no chart is divided."""
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        styles = self.browser.execute_script("""
            const value = (selector, name) => [...document.querySelectorAll(selector)].map((one) =>
                getComputedStyle(one)[name]);
            return [value("h1, h2, h3, h2 + p, tr.part, thead", "breakAfter"), value(".uplot, tr, figure, h2 + p", "breakInside")];
            """)
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        for found in styles:
            self.assertGreater(len(found), 10)
            self.assertEqual(set(found), {"avoid"})

    def contributions(self, column):
        """Contributions to a session's score, by key and in the order of the page: label and log odds."""
        cells = [(row.get_attribute("data-contribution"), row.find_elements(By.CSS_SELECTOR, "td"))
                 for row in column.find_elements(By.CSS_SELECTOR, "tr")]
        return {key: (label.text, float(odds.text.replace("−", "-"))) for key, (label, odds) in cells}

    def test_score_shows_contributions_and_unknown_outcome(self):
        scored = [recording("expert"), recording("no_lift")]  # without a lift the glottis is never seen
        self.page(*scored, killed())
        columns = self.find("#score .columns > div")
        expected = json.loads(support.run("eti-review", "score", "apply", *scored, "--json").stdout)
        self.assertEqual((len(columns), len(expected)), (3, 2))
        for column, score in zip(columns, expected):
            self.assertIn(f"{score['grade']:.1f} of 5\n", column.text)
            self.assertIn("No human data was used", column.text)
            self.assertIn(score["statement"], column.text)
            shown = self.contributions(column)
            self.assertGreater(len(shown), 3)
            sizes = [abs(odds) for _, odds in shown.values()]
            self.assertEqual(sizes, sorted(sizes, reverse=True))
            small = 0
            for one in score["contributions"]:
                if abs(one["log_odds"]) < 0.05:
                    small += 1
                else:
                    label, odds = shown.pop(one["key"])
                    self.assertEqual(label, one["label"] + ("" if one["measured"] else ": not reached, counted as the worst value"))
                    self.assertAlmostEqual(odds, one["log_odds"], delta=0.005 + 1e-9)
            self.assertEqual(shown, {})
            self.assertEqual(f"{small} more contribute less than 0.05 each" in column.text, small > 0)
        self.assertIn("\nIntubated\n", columns[0].text)
        self.assertIn("\nNot intubated\n", columns[1].text)
        self.assertIn("time to the first view of the glottis: not reached, counted as the worst value", columns[1].text)
        # An unknown outcome has no grade.
        self.assertIn("Not scored, as the outcome is unknown", columns[2].text)
        self.assertEqual(columns[2].find_elements(By.CSS_SELECTOR, "[data-grade], tr"), [])
        self.assertEqual(self.text("#outcome .outcome"), "Intubated Not intubated Outcome unknown")
        self.assertIn("cut off before its end", self.text("#outcome"))
        self.assert_numbers(self.cells(2), killed())
        columns[0].location_once_scrolled_into_view
        self.keep("score")
        self.assert_quiet()

    def test_broken_or_missing_score_error_contains_remedy(self):
        """A report for which no score was requested is made all the same."""
        shadow = self.folder / "data" / "scores" / "scripted.yaml"  # takes precedence over the shipped one
        shadow.parent.mkdir(parents=True)
        shipped = (support.ROOT / "deploy/data/scores/scripted.yaml").read_text()
        environment = os.environ | {"ETI_DATA": str(self.folder / "data")}

        def report(*arguments):
            return support.run("eti-review", "report", recording("expert"), "--out", self.folder / "out", *arguments,
                               timeout=120, env=environment)

        for broken, found in (("", "the file is empty"), ("\0\1\2", "not valid UTF-8"),
                              (shipped[:shipped.index("features:")], "features"),
                              (shipped[:shipped.index("weight:")], "not valid YAML"),
                              (shipped.replace("thresholds:", "tresholds:"), "thresholds"),
                              (re.sub("deviation: [0-9.]+", "deviation: 0", shipped, count=1), "deviation")):
            shadow.write_text(broken)
            done = report()
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(str(shadow), done.stderr)
            self.assertIn(found, done.stderr)
            self.assertIn("use --score none to write the report without a score", done.stderr)
        done = report("--score", "absent")
        self.assertEqual(done.returncode, 1)
        self.assertIn("'absent' is neither a file nor a name in", done.stderr)
        self.assertIn("use --score none to", done.stderr)
        self.assertFalse((self.folder / "out").exists())
        done = report("--score", "none")
        if "was built without the page" in done.stderr:
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("No human data", (self.folder / "out" / "report.html").read_text())

    def test_report_without_score_on_phone_and_in_print(self):
        rated = Path(shutil.copy(recording("expert"), self.folder / "rated.eti.h5"))
        self.assertEqual(support.run("eti-review", "rate", rated, "--rater", "ada", "--score", "overall=4").returncode, 0)
        self.page(rated, "--score", "none", width=500)
        self.assertEqual(self.text("#opinions td"), "overall 4 of 5 rated by ada")
        self.assertEqual(self.find("#score, [data-grade]"), [])
        self.assertEqual([one.text for one in self.find("h2") if "score" in one.text.lower()], [])
        self.assertGreater(len(self.cells()), 20)
        # A tap shows a definition.
        self.assertEqual(self.find("#parameters [title]"), [])
        names = self.find("#parameters .definition summary")
        self.assertEqual(len(names), len(self.cells()))
        shown = self.find("#parameters .definition > div")[0]
        self.assertFalse(shown.is_displayed())
        self.tap(names[0])
        support.wait_until(shown.is_displayed, "a definition")
        self.assertGreater(len(shown.text), 10)
        # A click on an event shows its moment, from which it can be played.
        event = self.find("#events button.moment")[1]
        event.click()
        shown = float(self.find("#anatomy .stage")[0].get_attribute("data-time"))
        self.assertAlmostEqual(shown, float(event.text.split()[0]), delta=0.05 + 1e-9)
        play = self.find("#anatomy button")[0]
        play.click()
        WebDriverWait(self.browser, 30).until(
            lambda _: float(self.find("#anatomy .stage")[0].get_attribute("data-time")) > shown + 0.2)
        play.click()
        # It scrolls only vertically.
        overflow = self.browser.execute_script(
            "return document.documentElement.scrollWidth - document.documentElement.clientWidth")
        self.assertLessEqual(overflow, 0)
        self.keep("telephone")
        printed = self.browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"]
        pdf = base64.b64decode(printed)
        (Path(SHOTS or self.folder) / "printed.pdf").write_bytes(pdf)
        sizes = set(re.findall(rb"/MediaBox ?\[([0-9. ]+)\]", pdf))
        self.assertEqual({tuple(round(float(one)) for one in size.split()) for size in sizes}, {(0, 0, 595, 842)})
        self.assert_headings_stay_with_their_content()
        self.assert_quiet()

    def test_hostile_text_is_escaped(self):
        file = self.folder / "hostile.eti.h5"
        shutil.copy(recording("expert"), file)
        with h5py.File(file, "r+") as opened:
            for name in ("session", "scenario", "operator", "start_time", "version"):
                opened["meta"].attrs[name] = HOSTILE
            width = opened["events/text"].dtype.itemsize
            opened["events/text"][...] = HOSTILE.encode()[:width]
            opened["summary/reason"][...] = HOSTILE.encode()[:opened["summary/reason"].dtype.itemsize]
        self.page(file)
        self.assertEqual(self.browser.title, "NeoETI report")
        self.assertIn(HOSTILE, self.text("#outcome"))
        self.assertEqual(self.find("img[src^=http]"), [])
        self.assert_quiet()

    def test_session_without_numbers_is_shown(self):
        file = self.folder / "nothing.eti.h5"
        shutil.copy(recording("expert"), file)
        with h5py.File(file, "r+") as opened:
            def empty(name, item):
                if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
                    item[...] = numpy.nan
            for group in ("metrics", "summary", "tools", "inputs", "deformation"):
                opened[group].visititems(empty)
        self.page(file)
        self.assertEqual({value for value, _ in self.cells().values()}, {"null"})
        self.assertEqual(self.find("#parameters .light"), [])
        self.assert_quiet()


if __name__ == "__main__":
    unittest.main()
