#!/usr/bin/env python3
"""view_browser.py - the page of leafcast view in headless Chromium: what view_page.py and view_page_crash.py share.

Their arguments are LEAFCAST FOLDER.
"""
import base64, json, os, re, subprocess, sys, time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains

from view_client import png_pixels, ok

leafcast, folder = sys.argv[1:3]
WAIT = 60
DESK, PHONE = (1280, 720), (390, 844)
FINAL = """const l = window.leafcast, h = l.screen.head;
return Boolean(h && h.final && h.number === l.link.number && !l.link.pending)"""


class Browser:
    def __init__(self):
        options = webdriver.ChromeOptions()
        for a in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                  "--force-color-profile=srgb", "--force-device-scale-factor=1", f"--user-data-dir={folder}/profile"):
            options.add_argument(a)
        options.add_experimental_option("prefs", {"download.default_directory": folder + "/saved",
                                                  "profile.default_content_setting_values.automatic_downloads": 1})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service("chromedriver"), options=options)
        self.canvas = None

    def size(self, width, height):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def js(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def until(self, text, *arguments):
        end = time.monotonic() + WAIT
        while time.monotonic() < end:
            if self.js(text, *arguments):
                return True
            time.sleep(0.02)
        return False

    def open(self, url):
        self.driver.get("about:blank")
        self.driver.get(url)
        self.until("return window.leafcast && leafcast.model")
        self.canvas = self.driver.find_element("id", "picture")
        return self.rest()

    def rest(self):
        """The final picture of what was asked for last: the hand has rested as long as the page waits for."""
        time.sleep(0.3)
        return self.until(FINAL)

    def pixels(self):
        data = self.js("return document.getElementById('picture').toDataURL('image/png')")
        return png_pixels(base64.b64decode(data.split(",")[1]))

    def click(self, name):
        self.js("document.getElementById(arguments[0]).click()", name)

    def flags(self):
        return json.loads(self.js("return decodeURIComponent(leafcast.fragment.slice(1))"))

    def reveal(self, name):
        self.js("document.getElementById(arguments[0]).open = true", name)
        self.js("document.getElementById(arguments[0]).scrollIntoView()", name)

    def choose(self, label, value):
        self.js("""const s = document.querySelector(`select[aria-label="${arguments[0]}"]`); s.value = arguments[1];
                s.dispatchEvent(new Event("change"))""", label, value)

    def hands(self):
        return ActionChains(self.driver, duration=20)


def rgb(pixels):
    """(width, height, R G B of all), whatever channels the file has."""
    width, height, data = pixels[0], pixels[1], pixels[-1]
    step = len(data) // (width * height)
    return width, height, b"".join(bytes(data[c::step]) for c in range(3))


def same(b, name):
    """The canvas is what the copied command draws."""
    b.click("copy-command")
    ok(f"{name}: the picture is that of the copied command", rgb(png_pixels(run_copied(b))) == rgb(b.pixels()))


def run_copied(b):
    """The file that the copied command writes, or the first of a movie."""
    line = b.js("return leafcast.copied")
    written = folder + "/" + re.search(r" -o (\S+)", line).group(1).replace("%04d", "0000")
    subprocess.run(["sh", "-c", f'leafcast() {{ "$LEAFCAST" "$@"; }}; {line} -q'], check=True, cwd=folder,
                   env=dict(os.environ, LEAFCAST=os.path.abspath(leafcast)))
    with open(written, "rb") as f:
        return f.read()


def value(b, label, number):
    b.js("""const e = document.querySelector(`[aria-label="${arguments[0]}"]`); e.value = arguments[1];
            e.dispatchEvent(new Event("change"))""", label, number)
    b.rest()


def saved(path):
    """Wait for what the browser saves: it puts an empty file in place first."""
    end = time.monotonic() + WAIT
    while not (os.path.exists(path) and os.path.getsize(path)) and time.monotonic() < end:
        time.sleep(0.05)
