#!/usr/bin/env python3
"""Uses the explorer as its users do, in a real Chromium through chromedriver: the page from disk without any network, and the live page.

    python3 tests/browser.py target/release/pbif
    python3 tests/browser.py target/release/pbif --images docs/images      # the pictures of docs/explorer.md as well
    python3 tests/browser.py target/release/pbif --measure                 # nothing but figures: 200 values at 100 x 100 cells, 10 000 requests

Python 3 alone. Exit status 77 where chromium or chromedriver is not installed (apt-get install chromium chromium-driver). What is hard to use without eyes or a mouse is looked for
by axe-core, where npm can fetch it, and by checks of its own in any case."""
import atexit, base64, json, os, pathlib, re, shutil, signal, socket, statistics, subprocess, sys, tempfile, time, urllib.error, urllib.request, xml.dom.minidom

ROOT = pathlib.Path(__file__).resolve().parent.parent
SMALL = ["--set", "cells.x.count=40", "--set", "cells.y.count=40", "--set", "locate.grid_check=off"]
ENTER, ESCAPE, END, HOME, RIGHT, TAB, BACKSPACE = "\ue007", "\ue00c", "\ue010", "\ue011", "\ue014", "\ue004", "\ue003"


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Browser:
    """A session of chromedriver."""

    opened = []

    def __init__(self, driver, offline, size="1280,900"):
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={size}", "--disable-background-networking"]
        if offline:
            arguments.append("--host-resolver-rules=MAP * ~NOTFOUND")
        options = {"args": arguments}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        self.base = driver
        found = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.base = f"{driver}/session/{found['sessionId']}"
        Browser.opened.append(self)

    def call(self, method, path, body=None):
        data = None if method == "GET" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(f"{method} {path}: {error.read().decode()[:600]}") from error

    def devtools(self, command, **parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def size(self, width, height):
        """The page in a window of any size: a window itself is never narrower than 500 pixels."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def picture(self, file):
        found = self.devtools("Page.captureScreenshot", format="png")["data"]
        pathlib.Path(file).write_bytes(base64.b64decode(found))

    def waits(self, script, *arguments):
        return self.call("POST", "/execute/async", {"script": script, "args": list(arguments)})

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

    def painted(self):
        """What was asked for is on the screen: the page draws in the next frame."""
        self.until("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))", "no picture")

    def element(self, selector):
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        # Away from the controls that stay at the top of the window.
        self.run("document.querySelector(arguments[0]).scrollIntoView({ block: 'center' })", selector)
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
        Browser.opened.remove(self)
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


def fetch_axe(folder):
    """The source of axe-core, by npm; nothing where that is not to be had."""
    if not shutil.which("npm"):
        return None
    command = ["npm", "install", "--prefix", folder, "--no-save", "--no-audit", "--no-fund", "--ignore-scripts", "axe-core@4"]
    try:
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120).returncode == 0
    except subprocess.TimeoutExpired:
        return None
    source = pathlib.Path(folder, "node_modules/axe-core/axe.min.js")
    return source.read_text() if done and source.is_file() else None


def is_usable(browser, axe, where):
    """No serious finding of axe-core."""
    if axe is None:
        return
    browser.run(f"{axe}; return null")
    found = browser.waits("""
        const done = arguments[arguments.length - 1];
        axe.run(document).then((all) => done(all.violations.filter(({ impact }) => ['serious', 'critical'].includes(impact))
          .map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.map(({ html, failureSummary }) => html.slice(0, 160) + ' ' + (failureSummary ?? '').slice(0, 200)).join(' | ')}`)),
          (error) => done([String(error)]));""")
    assert not found, f"{where}: " + "\n".join(found)


def fits(browser, where):
    """At eight widths nothing is wider than its window, and no text of a control is cut."""
    for width, height in ((360, 740), (390, 844), (768, 1024), (800, 1100), (1280, 900), (1366, 700), (1920, 1080), (3840, 2160)):
        browser.size(width, height)
        browser.painted()
        wide = browser.run("return [document.documentElement.scrollWidth, document.documentElement.clientWidth]")
        assert wide[0] <= wide[1], f"{where}, {width} pixels: the page is wider than its window, {wide}"
        cut = browser.run("""return [...document.querySelectorAll('button, label, h1, h2, figcaption, p')].filter((one) => one.checkVisibility()
            && (one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline')).map((one) => one.outerHTML.slice(0, 120))""")
        assert not cut, f"{where}, {width} pixels: {cut}"
    browser.size(1280, 900)


def is_in_one_screen(browser):
    """On a telephone the slider stays in sight above the joint density, which is whole below it, and above the diagram."""
    browser.size(390, 844)
    for canvas in ("joint-canvas", "diagram-canvas"):
        browser.run("document.getElementById(arguments[0]).scrollIntoView({ block: 'end' })", canvas)
        browser.painted()
        slide, plot = browser.run("""return ['slide', arguments[0]].map((id) => document.getElementById(id).getBoundingClientRect())
            .map(({ top, bottom }) => [top, bottom])""", canvas)
        assert 0 <= slide[0] and slide[1] <= plot[0] + 1 and plot[1] <= 845, f"slider at {slide}, {canvas} at {plot}"
    browser.size(1280, 900)
    browser.run("window.scrollTo(0, 0)")


def shows_numbers(browser):
    """Any column along the sweep: what is chosen is told at the shown value, a click goes elsewhere, the address keeps it."""
    names = browser.run("return [...document.querySelectorAll('#numbers-choice option')].map((one) => one.value)")
    assert {"mean_x", "sd_x", "sd_y", "solver_error"} <= set(names), names
    legend = "return document.getElementById('numbers-legend').textContent"
    told = set()
    for name in names:
        choose(browser, "#numbers-choice", name)
        # The first choice may be what is shown already, so that no change of the legend would tell that it was drawn.
        browser.painted()
        shown = browser.run(legend)
        assert shown not in told, f"{name} is not shown: {shown}"
        told.add(shown)
    choose(browser, "#numbers-choice", "sd_x")
    browser.until(f"{legend}.startsWith('standard deviation of x: ')", "the number is not told")
    before = browser.run(legend)
    point(browser, "#mark-canvas", 0.7, 0.5)
    browser.until(f"{legend} !== {json.dumps(before)}", "the numbers cannot be clicked")
    assert "numbers=sd_x" in browser.run("return location.hash"), "the address does not keep what is shown"


def copies(browser):
    """A caption, a table and a command are copied of a panel."""
    browser.run("window.copied = []; navigator.clipboard.writeText = async (text) => { window.copied.push(text); }")
    for number, (what, words) in enumerate((("caption", "Computed with pbif"), ("table", ","), ("command", "pbif plot RUN --only joint_xy --at "))):
        browser.run("const one = document.querySelector('#joint .exports select'); one.value = arguments[0]; one.dispatchEvent(new Event('change'))", what)
        browser.until(f"return window.copied.length > {number}", f"the {what} is not copied")
        assert words in browser.run(f"return window.copied[{number}]"), what


def saves(browser, folder, panels):
    """Every panel as SVG, PNG and CSV, as files that say what they are."""
    browser.devtools("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
    for panel in panels:
        for number, ending in enumerate(("svg", "png", "csv")):
            before = set(os.listdir(folder))
            # As a user does: a browser lets a page save many files only where it is asked for each.
            browser.click(f"{panel} .exports button:nth-child({number + 1})")
            end = time.time() + 20
            size = lambda name: os.path.getsize(os.path.join(folder, name))
            # A file is there before it is whole.
            last = 0
            while True:
                new = [name for name in set(os.listdir(folder)) - before if name.endswith(ending)]
                if new and 0 < last == size(new[0]):
                    break
                last = size(new[0]) if new else 0
                assert time.time() < end, f"{panel}: no {ending} was saved"
                time.sleep(0.05)
            content = pathlib.Path(folder, new[0]).read_bytes()
            if ending == "svg":
                assert xml.dom.minidom.parseString(content).documentElement.tagName == "svg"
            elif ending == "png":
                assert content.startswith(b"\x89PNG") and len(content) > 2000
            else:
                lines = content.decode().splitlines()
                assert len(lines) > 2 and all(line.count(",") == lines[0].count(",") for line in lines), lines[:3]
            os.remove(os.path.join(folder, new[0]))


def point(browser, canvas, across, up, by=(2, 0)):
    """Presses the mouse at a place of a canvas, in shares of its sides, and moves it by so many pixels before it is let go."""
    element = browser.element(canvas)
    rect = browser.run("arguments[0].scrollIntoView({ block: 'center' }); const r = arguments[0].getBoundingClientRect(); return [r.left, r.top, r.width, r.height]",
                       {"element-6066-11e4-a52e-4f735466cecf": element})
    x, y = round(rect[0] + across * rect[2]), round(rect[1] + (1 - up) * rect[3])
    actions = [{"type": "pointerMove", "x": x, "y": y}, {"type": "pointerDown", "button": 0}, {"type": "pointerMove", "x": x + by[0], "y": y + by[1], "duration": 20},
               {"type": "pointerUp", "button": 0}]
    browser.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}]})


def choose(browser, selector, value):
    browser.run("const one = document.querySelector(arguments[0]); one.value = arguments[1]; one.dispatchEvent(new Event('change'))", selector, value)


def from_disk(driver, page, axe, folder, images):
    browser = Browser(driver, True)
    browser.open(f"file://{page}")
    fits(browser, "the page of a run")
    is_in_one_screen(browser)
    copies(browser)
    if images:
        browser.open(f"file://{page}#f_c=-0.005")
        browser.picture(f"{images}/explorer.png")
    address = f"file://{page}"
    # What an address says wrongly changes nothing; what it says right is shown.
    browser.open(address + "#f_c=much&pin=NaN&joint=9&theme=loud")
    browser.told("f_c = ")
    browser.open(address + "#f_c=0.01&theme=dark")
    browser.told("f_c = 0.01: ")
    dark = browser.run("return getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", dark)[:3])) < 60, dark
    is_named(browser)
    laid = "return [...document.querySelectorAll('#equations .equation')].filter((one) => one.getBoundingClientRect().width > 30 && one.ariaLabel).length"
    assert browser.run(laid) == 3, "the equations are not typeset"
    assert browser.run("return document.querySelector('#equations msub').textContent") == "fc"
    assert not browser.run("return document.getElementById('paths').checkVisibility()"), "a saved page holds no equations that a path could follow"
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
    for wrong in ("much", "17"):
        browser.run("const typed = document.getElementById('typed'); typed.value = arguments[0]; typed.dispatchEvent(new Event('change'))", wrong)
        assert browser.run("return document.getElementById('refused').textContent"), f"{wrong} is not refused"
    choose(browser, "#typed", "-0.005")
    browser.told("f_c = −0.005: ")
    choose(browser, "#section", "0.5")
    browser.until("return !document.getElementById('section-figure').hidden", "a typed section is not shown")
    point(browser, "#joint-canvas", 0.4, 0.6)
    browser.until("return document.getElementById('section').value !== '0.5'", "a section cannot be dragged")
    point(browser, "#cursor-canvas", 0.3, 0.5)
    browser.until("return !document.getElementById('says').textContent.startsWith('f_c = −0.005:')", "the diagram cannot be clicked")
    before = browser.says()
    browser.click("#table button")
    browser.until(f"return document.getElementById('says').textContent !== {json.dumps(before)}", "the table leads nowhere")
    choose(browser, "#diagram-choice", browser.run("return document.querySelector('#diagram-choice option:last-child').value"))
    shows_numbers(browser)
    for theme in ("light", "dark"):
        choose(browser, "#theme", theme)
        is_usable(browser, axe, f"the page of a run, {theme}")
    saves(browser, folder, ("#joint", "#section-figure", "#marginals", "#diagram", "#numbers"))
    # Paper is white and holds every panel and label, though the screen is dark; the screen stays as it was.
    browser.devtools("Emulation.setEmulatedMedia", media="print")
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    white = browser.run("return getComputedStyle(document.body).backgroundColor")
    assert white == "rgb(255, 255, 255)", white
    assert browser.run("return ['joint', 'diagram'].every((id) => document.getElementById(id).getBoundingClientRect().height > 100)")
    assert browser.run("return document.querySelector('#table td button').checkVisibility()"), "labels are not printed"
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    browser.devtools("Emulation.setEmulatedMedia", media="")
    assert browser.run("return document.documentElement.dataset.theme") == "dark"
    assert not browser.console(), browser.console()
    browser.close()
    print("from disk: every control, keyboard alone, four widths, dark, odd addresses, saved files, nothing in the console")


def from_disk_map(driver, page, axe, folder, images):
    """The page of a map: its plane."""
    browser = Browser(driver, True)
    browser.open(f"file://{page}")
    fits(browser, "the page of a map")
    browser.open(f"file://{page}#h=0.05&a=0.5")
    browser.told("h = 0.05, a = 0.")
    if images:
        browser.picture(f"{images}/explorer_map.png")
    is_named(browser)
    # A click in the plane, at h = -0.4 and a = -0.3, where there is one peak.
    point(browser, "#place-canvas", 0.25, 0.35)
    browser.until("return /1 peak/.test(document.getElementById('says').textContent)", "the plane cannot be clicked")
    before = browser.says()
    browser.run("document.body.focus()")
    for key in ("\ue013", "\ue014"):  # up, right
        browser.press(key)
        browser.until(f"return document.getElementById('says').textContent !== {json.dumps(before)}", "the keyboard does not lead through the plane")
        before = browser.says()
    browser.press("p")
    browser.click("#curves button")
    browser.until("return /h = −?0, /.test(document.getElementById('says').textContent)", "the table of points leads nowhere")
    second = "#parameters input[type=text]"
    for wrong in ("much", "17"):
        choose(browser, second, wrong)
        assert browser.run("return document.getElementById('refused').textContent"), f"{wrong} is not refused"
    choose(browser, second, "1")
    browser.until("return document.getElementById('says').textContent.includes('a = 1:')", "a typed second value is not shown")
    # An address leads back.
    address, says = browser.run("return location.href"), browser.says()
    browser.open(address)
    browser.told(says)
    browser.until("return document.getElementById('pin').getAttribute('aria-pressed') === 'true'", "the address does not know of the pin")
    browser.open(f"file://{page}#h=much&a=&pin=1&plane=none")
    browser.told("h = 0, a = ")
    for theme in ("light", "dark"):
        choose(browser, "#theme", theme)
        is_usable(browser, axe, f"the page of a map, {theme}")
    saves(browser, folder, ("#plane",))
    assert not browser.console(), browser.console()
    browser.close()
    print("map from disk: clicks in the plane, keyboard alone, four widths, addresses, saved files, nothing in the console")


class Server:
    def __init__(self, pbif, folder, file="coulomb_fc", settings=SMALL):
        command = [pbif, "explore", str(ROOT / f"sweeps/{file}.toml"), *settings]
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


def dragged(browser, count):
    """Milliseconds from each of so many moves of the slider to its picture, ascending, and from the last one to full resolution."""
    times, rest = browser.waits("""
        const [count, done] = arguments, slide = document.getElementById('slide'), root = document.documentElement, times = [];
        const picture = () => new Promise(requestAnimationFrame);
        (async () => {
          for (let i = 1; i <= count; i++) {
            const start = performance.now(), before = root.dataset.solved;
            slide.value = Math.round(i * Number(slide.max) / count);
            slide.dispatchEvent(new Event('input', { bubbles: true }));
            while (root.dataset.solved === before && performance.now() - start < 5000) await picture();
            times.push(performance.now() - start);
          }
          const start = performance.now();
          while (!root.dataset.solved.endsWith('full') && performance.now() - start < 5000) await picture();
          done([times, performance.now() - start]);
        })();""", count)
    return sorted(times), rest


def locates(browser):
    """A change is narrowed where the cursor stands, and its row leads there."""
    browser.until("return window.performance.now() > 0 && document.getElementById('cursor-canvas').getAttribute('aria-valuetext')", "no diagram")
    choose(browser, "#typed", "-0.003")
    for _ in range(20):
        browser.run("document.getElementById('refused').textContent = ''")
        browser.click("#locate")
        browser.until("return !document.getElementById('locate').disabled", "locating does not end")
        if browser.run("return document.querySelectorAll('#table tbody tr').length"):
            break
        time.sleep(0.5)
    label = browser.run("return document.querySelector('#table tbody tr').textContent")
    assert label.startswith("PB1"), label


def follows_paths(browser, folder, axe):
    """Sample paths by mouse and by keyboard, followed anew at another value, kept in the address, saved and cleared."""
    drawn = lambda count: f"return (document.getElementById('joint-canvas').getAttribute('aria-label')?.match(/over it: (\\d+)/)?.[1] ?? '0') === '{count}'"
    section = lambda: browser.run("return document.getElementById('section').value")
    before = section()
    browser.click("#paths")
    browser.until("return document.getElementById('paths').getAttribute('aria-pressed') === 'true'", "the mode is not told")
    for number, place in enumerate(((0.4, 0.6), (0.55, 0.45)), 1):
        point(browser, "#joint-canvas", *place)
        browser.until(drawn(number), f"path {number} is not drawn")
    assert section() == before, "a click that starts a path lays a section"
    point(browser, "#joint-canvas", 0.4, 0.6, by=(0, 40))
    browser.until(f"return document.getElementById('section').value !== {json.dumps(before)}", "a section cannot be dragged while paths are started")
    assert browser.run(drawn(2)), "a drag starts a path"
    # Without a mouse, by its button and by its key.
    browser.run("document.getElementById('path-start').focus()")
    browser.press(ENTER)
    browser.until(drawn(3), "no path is started by the button")
    browser.run("document.activeElement.blur()")
    browser.press("s")
    browser.until(drawn(4), "no path is started by the key")
    browser.until("return /^4 paths of [\\d.]+ units of time, in \\d+ steps/.test(document.getElementById('path-says').textContent)", "nothing is said of the paths")
    for theme in ("light", "dark"):
        choose(browser, "#theme", theme)
        is_usable(browser, axe, f"the live page with paths, {theme}")
    fits(browser, "the live page with paths")
    # Other values, other paths: never those of the values before.
    says = browser.run("return document.getElementById('path-says').textContent")
    choose(browser, "#typed", "0.008")
    browser.told("f_c = 0.008")
    browser.until(drawn(4), "paths are not followed anew")
    assert browser.run("return document.getElementById('path-says').textContent") != says
    address = browser.run("return location.href")
    browser.open(address)
    browser.until(drawn(4), "an address does not lead back to its paths")
    browser.devtools("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
    browser.click("#joint .row .exports button:nth-child(1)")
    end = time.time() + 20
    while not (saved := [name for name in os.listdir(folder) if name.endswith(".svg")]):
        assert time.time() < end, "no picture was saved"
        time.sleep(0.05)
    colours = {line.getAttribute("stroke") for line in xml.dom.minidom.parse(os.path.join(folder, saved[0])).getElementsByTagName("polyline")
               if line.getAttribute("points").count(",") > 100}
    assert len(colours) == 5, f"four paths and the line beneath them should have five colours: {colours}"
    os.remove(os.path.join(folder, saved[0]))
    browser.click("#path-clear")
    browser.until(drawn(0), "paths cannot be cleared")
    assert "paths=" not in browser.run("return location.href")


def measure(driver, pbif, folder):
    """Figures for docs/explorer.md: nothing is asserted of them, since machines differ."""
    load = lambda: f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    server = Server(pbif, folder, settings=[])
    browser = Browser(driver, False)
    browser.open(server.address)
    browser.until("return document.documentElement.dataset.solved?.endsWith('full')", "nothing is solved")
    time.sleep(4)
    for turn in range(3):
        browser.run("const slide = document.getElementById('slide'); slide.value = 0; slide.dispatchEvent(new Event('input', { bubbles: true }))")
        time.sleep(1)
        times, rest = dragged(browser, 200)
        print(f"drag {turn + 1}: {statistics.median(times):.0f} ms in the median, {times[190]:.0f} ms at 95 %, {times[-1]:.0f} ms at most, full resolution after {rest:.0f} ms; {load()}")
    browser.close()
    memory = lambda: int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{server.process.pid}/status").read_text())[1]) // 1024
    began, sizes = time.time(), [memory()]
    for number in range(10000):
        values = {"f_c": -0.02 + 3e-6 * (number * 7919 % 10000)}
        body = json.dumps({"lane": "requests", "ticket": number + 1, "moving": "f_c", "values": values, "marginals_only": True}).encode()
        urllib.request.urlopen(urllib.request.Request(server.address + "solve", body, {"content-type": "application/json"}), timeout=60).read()
        if number % 1000 == 999:
            sizes.append(memory())
    print(f"10000 requests in {time.time() - began:.0f} s; MB after each thousand: {sizes}; {load()}")
    server.stop()


def live_map(driver, pbif, folder, axe):
    """The plane of a live page: clicked, mapped, and forgotten when another parameter moves."""
    server = Server(pbif, folder, "cusp", ["--set", "sweep.points=9", "--set", "map.points=9", "--set", "map.depth=1"])
    browser = Browser(driver, False)
    browser.open(server.address)
    browser.until("return document.documentElement.dataset.solved?.endsWith('full')", "nothing is solved")
    point(browser, "#place-canvas", 0.55, 0.85)
    browser.until("return /2 peaks/.test(document.getElementById('says').textContent)", "the plane cannot be clicked")
    browser.click("#map")
    browser.until("return document.querySelectorAll('#curves tbody tr').length >= 3", "the plane is not mapped")
    is_usable(browser, axe, "the live page of a map")
    fits(browser, "the live page of a map")
    choose(browser, "[data-name=sigma2] input[type=text]", "0.12")
    browser.until("return document.getElementById('curves').textContent.startsWith('No map yet')", "the map stays when another parameter moves")
    # Given up before it is made.
    browser.click("#map")
    browser.click("#map")
    browser.until("return document.getElementById('map').textContent === 'Map the plane'", "a map cannot be given up")
    assert not browser.console(), browser.console()
    browser.close()
    server.stop()
    print("live map: clicked, mapped, given up, nothing in the console")


WELL = """title = "A well that opens"
[system.equations]
x = "c x - x^5"
[system.noise]
x = "0.4"
[sweep]
parameter = "c"
from = -1
to = 1
points = 5
[cells]
x = { from = -2, to = 2, count = 60 }
"""


def edits(browser, axe, images):
    """Equations are changed in the page: what is wrong is said, with its place; what is right is shown at an address of its own; the way back leads
    to the system before."""
    before = browser.run("return location.pathname")
    browser.click("#edit")
    browser.until("return document.querySelectorAll('#editor-start option').length > 20", "the gallery is not listed")
    is_usable(browser, axe, "the editor")
    fits(browser, "the editor")
    if images:
        browser.picture(f"{images}/explorer_editor.png")
    choose(browser, "#editor-start", "vanderpol")
    browser.until("return document.getElementById('editor-text').value.includes('Van der Pol')", "no text of the gallery")
    write = "document.getElementById('editor-text').value = arguments[0]"
    browser.run(write, WELL.replace("x^5", "z^5"))
    browser.click("#editor-show")
    browser.until("return document.getElementById('editor-says').textContent.includes('^ here')", "nothing is said of a wrong formula")
    marked = browser.run("const { value, selectionStart, selectionEnd } = document.getElementById('editor-text'); return value.slice(selectionStart, selectionEnd)")
    assert marked.startswith("z^5"), marked
    is_usable(browser, axe, "the editor with an error")
    browser.run(write, WELL)
    browser.click("#editor-show")
    browser.until(f"return location.pathname !== '{before}' && document.documentElement.dataset.solved?.endsWith('full')", "the edited system is not shown")
    assert browser.run("return document.getElementById('title').textContent") == "A well that opens"
    browser.call("POST", "/back")
    browser.until(f"return location.pathname === '{before}' && document.documentElement.dataset.solved?.endsWith('full')", "the way back leads elsewhere")


def live_phases(driver, pbif, folder, axe):
    """Densities at phases of a forcing: a slider shows those of one phase, and the period runs."""
    settings = ["--set", "detect.marginals=[\"x @ 8 phases\"]", "--set", "cells.x.count=60"]
    server = Server(pbif, folder, "gallery/stochastic_resonance", settings)
    browser = Browser(driver, False)
    browser.open(server.address)
    browser.until("return document.documentElement.dataset.solved?.endsWith('full')", "nothing is solved")
    is_usable(browser, axe, "phases")
    fits(browser, "phases")
    shown = "return [...document.querySelectorAll('#marginals figure')].filter((one) => one.checkVisibility()).map((one) => one.getAttribute('aria-label'))"
    first = browser.run(shown)
    assert len(first) == 1, first
    browser.run("const phase = document.getElementById('phase'); phase.value = '2'; phase.dispatchEvent(new Event('input'))")
    assert browser.run("return document.getElementById('phase-says').textContent") == "0.25 of the period"
    second = browser.run(shown)
    assert len(second) == 1 and second != first, second
    browser.click("#run")
    browser.until("return document.getElementById('phase').value !== '2'", "the period does not run")
    browser.click("#run")
    assert not browser.console(), browser.console()
    browser.close()
    server.stop()
    print("phases: one at a time, a slider, a period that runs")


def live(driver, pbif, folder, axe, kept, images):
    server = Server(pbif, folder)
    browser = Browser(driver, False)
    browser.open(server.address)
    solved = "return document.documentElement.dataset.solved?.endsWith('full')"
    browser.until(solved, "nothing is solved")
    is_named(browser)
    is_usable(browser, axe, "the live page")
    fits(browser, "the live page")
    # Two tabs do not disturb each other.
    first = browser.call("GET", "/window")
    second = browser.call("POST", "/window/new", {"type": "tab"})["handle"]
    browser.call("POST", "/window", {"handle": second})
    browser.open(server.address + "#f_c=0.005")
    browser.until(solved, "nothing is solved in the second tab")
    browser.told("f_c = 0.005")
    browser.call("POST", "/window", {"handle": first})
    times, _ = dragged(browser, 60)
    print(f"live: slider to picture {statistics.median(times):.0f} ms in the median, {times[int(0.95 * len(times))]:.0f} ms at 95 %, of {len(times)}")
    assert times[-1] < 5000, times
    locates(browser)
    follows_paths(browser, kept, axe)
    edits(browser, axe, images)
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
    if images:
        again = Server(pbif, folder, settings=[])
        browser.open(again.address + "#f_c=-0.005&paths=0+1+0+0,0+1+0.9+0.3")
        browser.until("return /^2 paths/.test(document.getElementById('path-says').textContent)", "no paths for the picture")
        browser.picture(f"{images}/explorer_paths.png")
        again.stop()
    browser.close()
    print("live: two tabs, sample paths, edited systems, refused values, a server that is killed and started again")


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    images = sys.argv[sys.argv.index("--images") + 1] if "--images" in sys.argv else None
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
            at = f"http://127.0.0.1:{port}"
            if "--measure" in sys.argv:
                measure(at, pbif, folder)
                return 0
            axe = fetch_axe(os.path.join(folder, "npm"))
            print("axe-core looks for serious findings" if axe else "axe-core is not to be had: names, widths and the keyboard alone are checked")
            kept = os.path.join(folder, "saved")
            os.mkdir(kept)
            cells = [] if images else [*SMALL, "--set", "sweep.points=21"]
            pages = {"run": ["coulomb_fc", *cells, "--set", "figures.draw=[]"], "map": ["cusp", *([] if images else ["--set", "map.depth=1"])]}
            for name, (sweep, *settings) in pages.items():
                command = [pbif, "sweep", str(ROOT / f"sweeps/{sweep}.toml"), *settings, "--quiet", "--out", name]
                assert subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL).returncode in (0, 1)
                subprocess.run([pbif, "explore", name, "--html", f"{name}.html", "--quiet"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            from_disk(at, os.path.join(folder, "run.html"), axe, kept, images)
            from_disk_map(at, os.path.join(folder, "map.html"), axe, kept, images)
            live(at, pbif, folder, axe, kept, images)
            live_map(at, pbif, folder, axe)
            live_phases(at, pbif, folder, axe)
    finally:
        # A browser that a failed test left open would go on without its driver.
        for browser in list(Browser.opened):
            browser.close()
        driver.send_signal(signal.SIGTERM)
        driver.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
