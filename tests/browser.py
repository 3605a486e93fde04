#!/usr/bin/env python3
"""Uses the explorer as its users do, in a real Chromium through chromedriver: the page from disk without any network, and the live page.

    python3 tests/browser.py target/release/pbif

Python 3 alone. Exit status 77 where chromium or chromedriver is not installed (apt-get install chromium chromium-driver)."""
import atexit, json, os, pathlib, re, shutil, signal, socket, statistics, subprocess, sys, tempfile, time, urllib.error, urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
SMALL = ["--set", "cells.x.count=40", "--set", "cells.y.count=40", "--set", "locate.grid_check=off"]
ENTER, ESCAPE, END, HOME, RIGHT, TAB, BACKSPACE = "\ue007", "\ue00c", "\ue010", "\ue011", "\ue014", "\ue004", "\ue003"


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Browser:
    """A session of chromedriver."""

    def __init__(self, driver, offline, size="1280,900"):
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={size}", "--disable-background-networking"]
        if offline:
            arguments.append("--host-resolver-rules=MAP * ~NOTFOUND")
        options = {"args": arguments}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        self.base = driver
        found = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.base = f"{driver}/session/{found['sessionId']}"

    def call(self, method, path, body=None):
        data = None if method == "GET" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(f"{method} {path}: {error.read().decode()[:600]}") from error

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def open(self, address):
        # Another fragment alone would not load a page anew.
        self.call("POST", "/url", {"url": "about:blank"})
        self.call("POST", "/url", {"url": address})
        self.until("return document.documentElement.dataset.ready === 'true'", "the page is not ready")

    def until(self, script, words, seconds=60):
        end = time.time() + seconds
        while not self.run(script):
            assert time.time() < end, f"{words}; the page says: {self.says()}"
            time.sleep(0.02)

    def element(self, selector):
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        self.call("POST", f"/element/{self.element(selector)}/click")

    def type(self, selector, text):
        self.call("POST", f"/element/{self.element(selector)}/value", {"text": text})

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def says(self):
        return self.run("return document.getElementById('says')?.textContent ?? ''")

    def told(self, beginning):
        self.until(f"return document.getElementById('says').textContent.startsWith({json.dumps(beginning)})", f"not {beginning!r}")

    def console(self):
        return [entry["message"] for entry in self.call("POST", "/se/log", {"type": "browser"})]

    def close(self):
        self.call("DELETE", "")


def is_named(browser):
    """Every control has a name for screen readers, is reachable by the Tab key, and no name of an element is there twice."""
    found = browser.call("POST", "/elements", {"using": "css selector", "value": "button, input, select, summary, [role=slider], canvas[role=img]"})
    for reference in found:
        element = next(iter(reference.values()))
        try:
            label = browser.run("return arguments[0].checkVisibility()", reference) and browser.call("GET", f"/element/{element}/computedlabel")
        except AssertionError as error:
            # A live page writes its tables anew while it is looked at.
            assert "stale element" in str(error), error
            continue
        assert label is not None and label != "", browser.run("return arguments[0].outerHTML", reference)
    unreachable = browser.run("return [...document.querySelectorAll('button, input, select')].filter((one) => one.tabIndex < 0).map((one) => one.id)")
    assert not unreachable, unreachable
    twice = browser.run("const ids = [...document.querySelectorAll('[id]')].map((one) => one.id); return ids.filter((id, i) => ids.indexOf(id) !== i)")
    assert not twice, twice


def from_disk(driver, page):
    for size in ("500,800", "1280,900", "3840,2160"):
        browser = Browser(driver, True, size)
        browser.open(f"file://{page}")
        wide = browser.run("return [document.documentElement.scrollWidth, innerWidth]")
        assert wide[0] <= wide[1], f"{size}: the page is wider than its window, {wide}"
        browser.close()
    browser = Browser(driver, True)
    address = f"file://{page}"
    # What an address says wrongly changes nothing; what it says right is shown.
    browser.open(address + "#f_c=much&pin=NaN&joint=9&theme=loud")
    browser.told("f_c = ")
    browser.open(address + "#f_c=0.01&theme=dark")
    browser.told("f_c = 0.01: ")
    dark = browser.run("return getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", dark)[:3])) < 60, dark
    is_named(browser)
    # The keyboard alone.
    browser.run("document.body.focus()")
    for key, wanted in ((HOME, "f_c = −0.02: "), (END, "f_c = 0.01: "), (HOME, "f_c = −0.02: ")):
        browser.press(key)
        browser.told(wanted)
    before = browser.says()
    browser.press("n")
    browser.until(f"return document.getElementById('says').textContent !== {json.dumps(before)}", "no next change")
    browser.press("p", END, "d", "l", "k", "c", "m")
    assert browser.run("return document.getElementById('pin').getAttribute('aria-pressed')") == "true"
    assert browser.run("return ['log', 'lock', 'difference'].every((id) => document.getElementById(id).checked)")
    browser.press("?")
    assert browser.run("return document.getElementById('keys').open"), "? does not list the keys"
    browser.press(ESCAPE)
    assert not browser.run("return document.getElementById('keys').open")
    # Every control with the mouse; a typed value that is none is refused in words.
    for control in ("#previous", "#next", "#back", "#forth", "#play", "#play", "#pin", "#log", "#lock", "#contours", "#marks", "#about summary"):
        browser.click(control)
    browser.run("const typed = document.getElementById('typed'); typed.value = 'much'; typed.dispatchEvent(new Event('change'))")
    assert browser.run("return document.getElementById('refused').textContent"), "a value that is none is not refused"
    assert not browser.console(), browser.console()
    browser.close()
    print("from disk: every control, keyboard alone, three widths, dark, odd addresses, nothing in the console")


class Server:
    def __init__(self, pbif, folder):
        command = [pbif, "explore", str(ROOT / "sweeps/coulomb_fc.toml"), *SMALL]
        self.process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        atexit.register(self.process.kill)
        for line in self.process.stdout:
            found = re.search(r"http://\S+", line)
            if found:
                self.address = found.group()
                return
        raise AssertionError("no address was printed")

    def stop(self):
        self.process.kill()
        self.process.wait()


def live(driver, pbif, folder):
    server = Server(pbif, folder)
    browser = Browser(driver, False)
    browser.open(server.address)
    solved = "return document.documentElement.dataset.solved?.endsWith('full')"
    browser.until(solved, "nothing is solved")
    is_named(browser)
    # Two tabs do not disturb each other.
    first = browser.call("GET", "/window")
    second = browser.call("POST", "/window/new", {"type": "tab"})["handle"]
    browser.call("POST", "/window", {"handle": second})
    browser.open(server.address + "#f_c=0.005")
    browser.until(solved, "nothing is solved in the second tab")
    browser.told("f_c = 0.005")
    browser.call("POST", "/window", {"handle": first})
    # A drag of the slider: from each move to its picture.
    times = browser.call("POST", "/execute/async", {"args": [], "script": """
        const done = arguments[arguments.length - 1], slide = document.getElementById('slide'), root = document.documentElement, times = [];
        (async () => {
          for (let i = 1; i <= 60; i++) {
            const start = performance.now(), before = root.dataset.solved;
            slide.value = Math.round(i * Number(slide.max) / 60);
            slide.dispatchEvent(new Event('input', { bubbles: true }));
            while (root.dataset.solved === before && performance.now() - start < 5000) await new Promise(requestAnimationFrame);
            times.push(performance.now() - start);
          }
          done(times);
        })();"""})
    times.sort()
    print(f"live: slider to picture {statistics.median(times):.0f} ms in the median, {times[int(0.95 * len(times))]:.0f} ms at 95 %, of {len(times)}")
    assert times[-1] < 5000, times
    browser.run("const typed = document.getElementById('typed'); typed.value = '1e999'; typed.dispatchEvent(new Event('change'))")
    browser.until("return document.getElementById('refused').textContent !== ''", "a value that is none is not refused")
    assert not browser.console(), browser.console()
    # A server that is gone is said; a new one has another address.
    server.stop()
    browser.run("const slide = document.getElementById('slide'); slide.value = slide.min; slide.dispatchEvent(new Event('input', { bubbles: true }))")
    browser.until("return document.body.textContent.includes('The server does not answer')", "nothing is said of the server that has gone")
    again = Server(pbif, folder)
    assert again.address != server.address
    browser.open(again.address)
    browser.until(solved, "nothing is solved by the server that was started again")
    again.stop()
    browser.close()
    print("live: two tabs, refused values, a server that is killed and started again")


def main():
    pbif = str(pathlib.Path(sys.argv[1]).resolve())
    if not shutil.which("chromedriver") or not (shutil.which("chromium") or shutil.which("google-chrome")):
        print("skipped: chromium or chromedriver is not installed")
        return 77
    port = free_port()
    driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(100):
                try:
                    urllib.request.urlopen(f"http://127.0.0.1:{port}/status", timeout=5).close()
                    break
                except OSError:
                    time.sleep(0.1)
            sweep = [pbif, "sweep", str(ROOT / "sweeps/coulomb_fc.toml"), *SMALL, "--set", "sweep.points=21", "--set", "figures.draw=[]", "--quiet", "--out", "run"]
            assert subprocess.run(sweep, cwd=folder, stdout=subprocess.DEVNULL).returncode in (0, 1)
            subprocess.run([pbif, "explore", "run", "--html", "page.html"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            at = f"http://127.0.0.1:{port}"
            from_disk(at, os.path.join(folder, "page.html"))
            live(at, pbif, folder)
    finally:
        driver.send_signal(signal.SIGTERM)
        driver.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
