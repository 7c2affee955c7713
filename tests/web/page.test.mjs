// The page in a real browser, served by the real program: drawing, controls, loss of the connection.
//
//   SWEEPCAST_BINARY=path/to/sweepcast node page.test.mjs     starts the program itself
//   node page.test.mjs http://127.0.0.1:8080/                 uses one that runs (or SWEEPCAST_URL)
//
// CHROMIUM names the browser (default /usr/bin/chromium). Ends with "N passed, N failed".
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { Gateway } from "./support_gateway.mjs";
import { comparePoints } from "./support_canvas.mjs";

const require = createRequire(new URL("../../web/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const { AxeBuilder } = require("@axe-core/playwright");

const BROWSER_ARGUMENTS = [
  "--no-sandbox",
  "--headless",
  "--disable-gpu",
  "--disable-dev-shm-usage",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
/// Generous: a loaded machine is slow, and no test waits longer than for its event.
const DEADLINE_MS = 60_000;
const DESKTOP = { viewport: { width: 1280, height: 800 }, colorScheme: "light" };
const PHONE = {
  viewport: { width: 360, height: 740 },
  deviceScaleFactor: 3,
  colorScheme: "dark",
  hasTouch: true,
  isMobile: true,
};

const binary = process.env.SWEEPCAST_BINARY;
let gateway;
let others;
let base = process.argv[2] ?? process.env.SWEEPCAST_URL;
let browser;
let page;
const complaints = [];
const tests = [];
const test = (name, run) => tests.push({ name, run });

// The page in a window of this kind, connected.
async function open(options, address = base) {
  await page?.context().close();
  const context = await browser.newContext(options);
  page = await context.newPage();
  page.setDefaultTimeout(DEADLINE_MS);
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
  });
  await page.goto(address);
  await until(() => window.sweepcast?.connected);
}

const until = (condition, argument) => page.waitForFunction(condition, argument);
const untilState = (state) => until((wanted) => window.sweepcast.state === wanted, state);
const text = (selector) => page.textContent(selector);
const view = () => page.evaluate(() => window.sweepcast.view);
const untilShown = (id, wanted) =>
  until(([place, text]) => document.querySelector(place).textContent === text, [id, wanted]);
// Buttons go on and off with the answers to commands, which may come after the state that they bring about.
const untilEnabled = (id) => page.waitForSelector(`${id}[aria-disabled="false"]`);
const untilDisabled = (id) => page.waitForSelector(`${id}[aria-disabled="true"]`);
const press = async (id) => {
  await untilEnabled(id);
  await page.click(id);
};
const untilSweeps = async (count) => {
  const before = await page.evaluate(() => window.sweepcast.sequence);
  await until((sequence) => window.sweepcast.sequence >= sequence, before + count);
};

// Brings the lidar to scanning with the page's own button, if it does not scan yet.
async function startScanning() {
  await until(() => ["IDLE", "SCANNING"].includes(window.sweepcast.state));
  if ((await page.evaluate(() => window.sweepcast.state)) === "IDLE") await press("#start");
  await untilState("SCANNING");
  await until(() => window.sweepcast.points > 50 && !window.sweepcast.stale);
}

async function stopScanning() {
  await press("#stop");
  await untilState("IDLE");
}

async function assertDrawn() {
  const drawn = await page.evaluate(comparePoints);
  assert.ok(drawn.points > 50, `only ${drawn.points} points in sight`);
  assert.deepEqual(
    { unlit: drawn.unlit, miscoloured: drawn.miscoloured, stray: drawn.stray },
    { unlit: 0, miscoloured: 0, stray: 0 },
  );
  assert.ok(drawn.colours > 1, "all points have one colour");
}

// Has requests refused as the gateway refuses them, until accept().
const refuse = (pattern, status, message, hint) =>
  page.route(pattern, (route) =>
    route.fulfill({ status, json: { error: { code: "refused", message, hint } } }),
  );

async function accept(pattern, status) {
  await page.unroute(pattern);
  // The browser reports a refused request on its console, sooner or later; that one was meant.
  const meant = () => complaints.findIndex((complaint) => complaint.includes(`${status}`));
  while (meant() < 0) await page.waitForEvent("console");
  complaints.splice(meant(), 1);
}

async function assertAccessible() {
  const { violations } = await new AxeBuilder({ page }).analyze();
  assert.deepEqual(
    violations.map(({ id, nodes }) => [id, nodes.map(({ target }) => target).join()]),
    [],
  );
}

// The middle of the drawing, on the page and on the drawing.
async function middle() {
  const box = await page.locator("#overlay").boundingBox();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width };
}

// A point that can be pointed at: clear of the edges, where buttons and readout are, and of the lidar. The
// farthest one: that is a wall, and does not walk away. A point has its place on the screen once it is drawn, so
// a view that has just changed is drawn first.
const clearPoint = () =>
  page.evaluate(async () => {
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
    const near = (a, b) => Math.hypot(a.x - b.x, a.y - b.y) < 6;
    const { width, height } = window.sweepcast.view;
    let best;
    for (let k = 1; k + 1 < window.sweepcast.points; ++k) {
      const [before, point, after] = [k - 1, k, k + 1].map((each) => window.sweepcast.point(each));
      // Where a beam grazes a wall, points lie far apart, and each sweep has them elsewhere.
      const dense = near(before, point) && near(point, after);
      const inside = point.x > 80 && point.x < width - 80 && point.y > 80 && point.y < height - 180;
      const away = Math.hypot(point.x - width / 2, point.y - height / 2);
      const farther = !best || point.distance_m > best.distance_m;
      if (dense && inside && away > 40 && farther) best = point;
    }
    return best;
  });

const floorAt = (v, x, y) => [
  v.centreX + (x - v.width / 2) / v.scale,
  v.centreY - (y - v.height / 2) / v.scale,
];

test("the page names the lidar and says that it is virtual", async () => {
  await open(DESKTOP);
  await until(() => document.getElementById("serial").textContent.length === 32);
  assert.match(await text("#model"), /A1M8/);
  assert.ok(await page.isVisible("#virtual-note"));
  assert.ok(await page.isHidden("#banner"));
});

test("start turns the lidar, and sweeps are drawn and measured", async () => {
  await startScanning();
  await until(() => parseInt(document.getElementById("rpm").textContent) > 60);
  await until(() => Number(document.getElementById("sweeps-per-second").textContent) > 1);
  assert.match(await text("#state-word"), /Scanning/);
  assert.match(await text("#summary"), /Nearest obstacle \d+\.\d+ m at \d+°/);
});

test("start is off and stop is on while it scans", async () => {
  await untilDisabled("#start");
  await untilEnabled("#stop");
});

test("the line's quality is told in words, and its numbers on demand", async () => {
  await until(() =>
    /^(Clean|[\d,]+ packets?)/.test(document.getElementById("line-quality").textContent),
  );
  assert.ok(await page.isHidden("#line-samples"));
  await page.focus("summary");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#line-samples", { state: "visible" });
  await until(() => /\d/.test(document.getElementById("line-samples").textContent));
  await page.keyboard.press("Enter");
  assert.equal(await text("#baud"), "115,200 baud");
});

test("where the motor cannot be told a speed none is asked for", async () => {
  await page.waitForSelector("#rotation", { state: "visible" });
  assert.ok(await page.isHidden("#speed-form"));
  assert.ok(await page.isHidden("#speed-warning"));
  assert.match(await text("#speed-aim"), /Fixed/);
});

test("nothing moves about while the figures change", async () => {
  await page.evaluate(() => {
    window.shifts = [];
    new PerformanceObserver((list) => {
      for (const { value, sources } of list.getEntries())
        window.shifts.push([value, ...sources.map(({ node }) => node?.id ?? node?.nodeName)]);
    }).observe({ type: "layout-shift" });
  });
  await untilSweeps(20);
  assert.deepEqual(await page.evaluate(() => window.shifts), []);
});

for (const scheme of ["light", "dark"]) {
  test(`every point is drawn where it belongs, in its colour, and nothing else (${scheme})`, async () => {
    await page.emulateMedia({ colorScheme: scheme });
    await untilSweeps(2);
    await assertDrawn();
  });

  test(`the page has no accessibility fault that axe finds (${scheme})`, async () => {
    await assertAccessible();
  });
}

test("the two themes draw on different grounds", async () => {
  const ground = () =>
    page.evaluate(() => getComputedStyle(document.getElementById("stage")).backgroundColor);
  await page.emulateMedia({ colorScheme: "dark" });
  const dark = await ground();
  await page.emulateMedia({ colorScheme: "light" });
  assert.notEqual(await ground(), dark);
});

test("near points and far points differ in colour", async () => {
  const [near, far] = await page.evaluate(() => {
    const points = Array.from({ length: window.sweepcast.points }, (_, k) =>
      window.sweepcast.point(k),
    ).sort((a, b) => a.distance_m - b.distance_m);
    return [points[0], points[points.length - 1]];
  });
  assert.ok(far.distance_m > near.distance_m);
  assert.notDeepEqual(near.colour, far.colour);
});

test("the colours can show the quality, and the choice is remembered", async () => {
  await page.check("#colour-quality");
  await until(() => document.getElementById("ramp-high").textContent === "255");
  assert.match(new URL(page.url()).hash, /colour=quality/);
  await page.reload();
  await until(() => window.sweepcast?.connected);
  assert.ok(await page.isChecked("#colour-quality"));
  await page.check("#colour-range");
});

test("pointing at a point tells its angle, distance and quality", async () => {
  await until(() => window.sweepcast.points > 50);
  await page.click("#zoom-out"); // from here on the view follows no sweep
  const point = await clearPoint();
  const { scale } = await view();
  const box = await page.locator("#overlay").boundingBox();
  await page.mouse.move(box.x + point.x, box.y + point.y);
  // Read in one go: a sweep may come without an echo there.
  const handle = await until(() => {
    const { hidden, textContent } = document.getElementById("readout");
    return !hidden && textContent;
  });
  const readout = await handle.jsonValue();
  const [, angle, distance] = readout.match(/^(\d+\.\d+)° +(\d+\.\d+) m +quality \d+$/) ?? [];
  // A later sweep's point there is another, but within the pointer's reach of 24 pixels.
  const reach = 24 / scale;
  const apart = Math.abs(Number(angle) - point.angle_deg);
  const widest = (Math.asin(reach / point.distance_m) * 180) / Math.PI;
  assert.ok(Math.min(apart, 360 - apart) <= widest + 0.01, `${readout} for ${point.angle_deg}`);
  assert.ok(Math.abs(Number(distance) - point.distance_m) <= reach + 0.001, readout);
});

test("the wheel magnifies about the pointer", async () => {
  const box = await page.locator("#overlay").boundingBox();
  const [x, y] = [200, 150];
  await page.click("#zoom-out"); // from here on the view follows no sweep
  const before = await view();
  await page.mouse.move(box.x + x, box.y + y);
  await page.mouse.wheel(0, -200);
  await until((scale) => window.sweepcast.view.scale > scale, before.scale);
  const after = await view();
  const [expected, actual] = [floorAt(before, x, y), floorAt(after, x, y)];
  actual.forEach((value, k) => assert.ok(Math.abs(value - expected[k]) < 1e-6));
});

test("dragging moves the floor with the pointer", async () => {
  const { x, y } = await middle();
  const before = await view();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y - 40);
  await page.mouse.up();
  const after = await view();
  assert.ok(Math.abs((before.centreX - after.centreX) * after.scale - 60) < 1e-6);
  assert.ok(Math.abs((before.centreY - after.centreY) * after.scale - 40) < 1e-6);
  await assertDrawn();
});

test("the keyboard pans, magnifies and fits", async () => {
  await page.focus("#overlay");
  const before = await view();
  await page.keyboard.press("ArrowLeft");
  assert.ok((await view()).centreX < before.centreX);
  await page.keyboard.press("+");
  assert.ok((await view()).scale > before.scale);
  await page.keyboard.press("-");
  assert.ok(Math.abs((await view()).scale - before.scale) < 1e-6);
  await page.keyboard.press("0");
  const fitted = await view();
  assert.deepEqual([fitted.centreX, fitted.centreY], [0, 0]);
});

test("fit brings the room into sight with the lidar in the middle", async () => {
  await page.click("#zoom-in");
  await page.click("#zoom-in");
  await page.click("#fit");
  const { centreX, centreY, width, height } = await view();
  assert.deepEqual([centreX, centreY], [0, 0]);
  // The points are those of the last picture: the first with the new view may be yet to come.
  await page.waitForFunction(
    ([w, h]) =>
      Array.from({ length: window.sweepcast.points }, (_, k) => window.sweepcast.point(k)).filter(
        ({ x, y }) => x >= 0 && y >= 0 && x <= w && y <= h,
      ).length >=
      0.98 * window.sweepcast.points,
    [width, height],
  );
});

// Remembers how the overlay looks. The pointer is elsewhere, so only the sweep line can move on it.
const rememberOverlay = () =>
  page.evaluate(() => {
    const canvas = document.getElementById("overlay");
    window.overlayLook = () =>
      canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.join("");
    window.overlayBefore = window.overlayLook();
  });

test("the sweep line turns, unless less motion is wished for", async () => {
  await page.mouse.move(1270, 790);
  await page.waitForSelector("#readout", { state: "hidden" });
  await rememberOverlay();
  await until(() => window.overlayLook() !== window.overlayBefore);
  await page.emulateMedia({ reducedMotion: "reduce" });
  // The line goes with the next picture; after that nothing moves however many sweeps come.
  await untilSweeps(2);
  await rememberOverlay();
  await untilSweeps(3);
  assert.ok(await page.evaluate(() => window.overlayLook() === window.overlayBefore));
  await page.emulateMedia({ reducedMotion: "no-preference" });
});

test("stop ends the scan; the last sweep stays, marked as old", async () => {
  await stopScanning();
  assert.match(await text("#state-word"), /motor off/);
  await until(() => document.getElementById("stage").classList.contains("stale"));
  await until(() => getComputedStyle(document.getElementById("points")).opacity < 0.5);
  assert.match(await text("#stage-note"), /Last sweep/);
  assert.ok((await page.evaluate(() => window.sweepcast.points)) > 50);
  await untilEnabled("#start");
  await untilDisabled("#stop");
});

// Picks a mode other than the one in use, and gives its name once the lidar has been told.
async function pickOtherMode() {
  const current = await page.inputValue("#mode-picker");
  const modes = await page
    .locator("#mode-picker option")
    .evaluateAll((options) => options.map(({ value }) => value));
  const other = modes.find((mode) => mode !== current);
  const request = page.waitForRequest((each) => each.method() === "PATCH");
  await page.selectOption("#mode-picker", other);
  assert.deepEqual((await request).postDataJSON(), { mode: other });
  await until(() => !/Changing/.test(document.getElementById("mode-note").textContent));
  assert.equal(await page.inputValue("#mode-picker"), other);
  assert.ok(await page.isHidden("#trouble"));
  return other;
}

test("the modes are listed with rate and reach, the typical one marked", async () => {
  const modes = await page.locator("#mode-picker option").allTextContents();
  assert.ok(modes.includes("Standard – 2 kHz, 12 m"), modes.join("; "));
  assert.ok(modes.includes("Express – 4 kHz, 12 m (typical)"), modes.join("; "));
  assert.equal(modes.filter((mode) => mode.includes("typical")).length, 1);
  assert.equal(await text("#mode-note"), "4,000 samples/s, up to 12 m");
});

test("a picked mode is the one it starts in", async () => {
  const mode = await pickOtherMode();
  await press("#start");
  await untilState("SCANNING");
  await until((wanted) => window.sweepcast.mode === wanted && !window.sweepcast.stale, mode);
});

test("while it scans another mode is in use as soon as it is picked", async () => {
  const mode = await pickOtherMode();
  await until((wanted) => window.sweepcast.mode === wanted, mode);
  await untilState("SCANNING");
});

test("a mode that is refused is told, and the picker shows the one in use", async () => {
  const current = await page.inputValue("#mode-picker");
  await refuse("**/api/v1/lidars/*", 409, "no scan mode like that", "this lidar has others");
  await page.selectOption("#mode-picker", { index: current === "Standard" ? 1 : 0 });
  await page.waitForSelector("#trouble:not([hidden])");
  assert.equal(await text("#trouble-message"), "no scan mode like that");
  await until((wanted) => document.getElementById("mode-picker").value === wanted, current);
  await accept("**/api/v1/lidars/*", 409);
});

test("reset brings the lidar back", async () => {
  // It may pass through its states faster than they can be asked for.
  await page.evaluate(() => {
    window.wordsSeen = [];
    const word = document.getElementById("state-word");
    new MutationObserver(() => window.wordsSeen.push(word.textContent)).observe(word, {
      childList: true,
    });
  });
  const answer = page.waitForResponse((each) => each.url().endsWith("/reset"));
  await press("#reset");
  assert.equal((await answer).status(), 200);
  await until(() => window.wordsSeen.includes("Resetting"));
  await until(() => document.getElementById("reset").textContent === "Reset");
  await startScanning();
});

test("what the gateway refuses is told with its hint, and can be dismissed", async () => {
  await refuse("**/stop", 409, "the motor is stuck", "free it");
  await press("#stop");
  await page.waitForSelector("#trouble:not([hidden])");
  assert.equal(await text("#trouble-message"), "the motor is stuck");
  assert.equal(await text("#trouble-hint"), "free it");
  await page.click("#trouble-dismiss");
  assert.ok(await page.isHidden("#trouble"));
  await accept("**/stop", 409);
});

test("on a phone the drawing is on top, nothing is cut off, and targets are large", async () => {
  await open(PHONE);
  await startScanning();
  const layout = await page.evaluate(() => ({
    overflow: document.documentElement.scrollWidth - innerWidth,
    drawingEnds: document.getElementById("stage").getBoundingClientRect().bottom,
    panelBegins: document.querySelector(".panel").getBoundingClientRect().top,
    small: [...document.querySelectorAll("button, select, summary, .colour label, .lidar")]
      .filter((each) => each.offsetParent !== null)
      .filter((each) => each.offsetHeight < 44 || each.offsetWidth < 44)
      .map((each) => each.id || each.textContent),
  }));
  assert.ok(layout.overflow <= 0, `${layout.overflow} px too wide`);
  assert.ok(layout.drawingEnds <= layout.panelBegins);
  assert.deepEqual(layout.small, []);
});

test("on a dense screen the points are drawn with all its pixels", async () => {
  const ratio = await page.evaluate(() => {
    const canvas = document.getElementById("points");
    return canvas.width / canvas.clientWidth;
  });
  assert.equal(ratio, 3);
  await assertDrawn();
});

test("one finger pans and two magnify", async () => {
  const session = await page.context().newCDPSession(page);
  const { x, y } = await middle();
  const touch = (type, ...points) =>
    session.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })),
    });
  await page.tap("#zoom-out"); // from here on the view follows no sweep
  const before = await view();
  await touch("touchStart", [x, y]);
  await touch("touchMove", [x + 20, y]);
  await touch("touchMove", [x + 40, y]);
  await touch("touchEnd");
  await until((centreX) => window.sweepcast.view.centreX < centreX, before.centreX);
  const panned = await view();
  assert.equal(panned.scale, before.scale);

  await touch("touchStart", [x - 30, y], [x + 30, y]);
  await touch("touchMove", [x - 60, y], [x + 60, y]);
  await touch("touchEnd");
  await until((scale) => window.sweepcast.view.scale > scale * 1.8, panned.scale);
  assert.ok((await view()).scale < panned.scale * 2.2);
  await page.tap("#fit");
});

test("a tap tells the point", async () => {
  const point = await clearPoint();
  const box = await page.locator("#overlay").boundingBox();
  await page.touchscreen.tap(box.x + point.x, box.y + point.y);
  await page.waitForSelector("#readout:not([hidden])");
});

if (binary) {
  test("a lost connection shows, and the drawing with it", async () => {
    await open(DESKTOP);
    await startScanning();
    await gateway.crash();
    await page.waitForSelector("#banner:not([hidden])");
    await until(() => /in \d+ s|now/.test(document.getElementById("banner-countdown").textContent));
    await until(() => document.getElementById("stage").classList.contains("stale"));
    assert.equal(await page.evaluate(() => window.sweepcast.connected), false);
    assert.match(await text("#link"), /Not connected/);
    assert.equal(await text("#state-word"), "Unknown");
    await untilDisabled("#start");
    await untilDisabled("#stop");
  });

  test("the page comes back by itself with the gateway", async () => {
    gateway = await Gateway.start(binary, { address: gateway.address });
    await until(() => window.sweepcast.connected);
    await page.waitForSelector("#banner", { state: "hidden" });
    await startScanning();
    await assertDrawn();
    // Refused attempts were reported on the browser's console meanwhile, as they should be.
    complaints.length = 0;
  });
}

// Several lidars, among them one whose speed can be set, one that was told a speed and cannot obey, and one that
// is not there.
const MISSING = "/dev/sweepcast-test-no-such-port";
const row = (title) => page.locator(".lidar", { hasText: title }).locator("input");

if (binary) {
  test("of several lidars each is listed with its model and state", async () => {
    others = await Gateway.start(binary, { lidars: ["virtual:a2m8", "virtual:c1?hz=8", MISSING] });
    await open(DESKTOP, others.url);
    await until(() => document.querySelectorAll(".lidar").length === 3);
    await until(() => document.querySelectorAll(".lidar[data-tone=good]").length === 2);
    await until(() => document.querySelectorAll(".lidar[data-tone=bad]").length === 1);
    const rows = await page.locator(".lidar").allTextContents();
    assert.match(rows[0], /A2M8.*Scanning/);
    assert.match(rows[1], /C1.*Scanning/);
    assert.match(rows[2], new RegExp(`${MISSING}.*Not there`));
  });

  test("a speed that is set is reached, and said to be", async () => {
    await row("A2M8").check();
    await startScanning();
    await page.fill("#speed", "7");
    const request = page.waitForRequest((each) => each.method() === "PATCH");
    await page.press("#speed", "Enter");
    assert.deepEqual((await request).postDataJSON(), { speed_hz: 7 });
    await untilShown("#speed-aim", "Settled at 7.0 Hz");
    await until(
      () => Math.abs(parseFloat(document.getElementById("speed-measured").textContent) - 7) < 0.3,
    );
  });

  test("a speed that is none is refused beside the field, and not sent", async () => {
    let sent = false;
    page.once("request", (request) => (sent ||= request.method() === "PATCH"));
    await page.fill("#speed", "99");
    await page.click("#speed-set");
    assert.match(await text("#speed-note"), /5\.0 to 15\.0 Hz/);
    assert.equal(await page.getAttribute("#speed", "aria-invalid"), "true");
    assert.equal(sent, false);
  });

  test("the usual speed is a button away", async () => {
    await press("#speed-usual");
    await untilShown("#speed-aim", "Settled at 10.0 Hz");
    assert.equal(await page.inputValue("#speed"), "10");
    assert.equal(await page.getAttribute("#speed", "aria-invalid"), "false");
  });

  test("the list of lidars is used by keyboard", async () => {
    await row("A2M8").focus();
    await page.keyboard.press("ArrowDown");
    await until(() => document.getElementById("model").textContent.startsWith("C1"));
    assert.ok(await row("C1").evaluate((input) => input === document.activeElement));
    await startScanning();
    await assertDrawn();
  });

  test("the first sectors of a lidar that is chosen have their colours at once", async () => {
    await row("A2M8").check();
    await until(
      () =>
        document.getElementById("model").textContent.startsWith("A2M8") &&
        window.sweepcast.points > 50,
    );
    const first = page.waitForFunction(() => {
      const { points, point } = window.sweepcast;
      const colours = new Set(Array.from({ length: points }, (_, k) => point(k).colour.join()));
      const chosen = document.getElementById("model").textContent.startsWith("C1");
      return chosen && points > 50 && { points, colours: colours.size };
    });
    await row("C1").check();
    const { colours } = await (await first).jsonValue();
    assert.ok(colours > 1, "all points have one colour");
    await startScanning();
  });

  test("a lidar that cannot obey a speed says so, offers none, and the wish can be withdrawn", async () => {
    await page.waitForSelector("#speed-warning:not([hidden])");
    assert.match(await text("#speed-warning"), /cannot be changed/);
    assert.ok(await page.isHidden("#speed-form"));
    await press("#speed-withdraw");
    await page.waitForSelector("#speed-warning", { state: "hidden" });
  });

  const DIAGNOSIS = {
    port: MISSING,
    verdict: "FAILED",
    checks: [
      { id: "a", title: "First", verdict: "OK", finding: "as it should be" },
      { id: "b", title: "Second", verdict: "WARNING", finding: "hardly" },
      { id: "c", title: "Third", verdict: "FAILED", finding: "no such file" },
      { id: "d", title: "Fourth", verdict: "NOT_RUN" },
    ],
    cause: "there is no port",
    likely_causes: ["it is not plugged in", "the cable is broken"],
    next_steps: ["plug it in"],
  };

  test("a diagnosis shows that it runs, then cause, steps and each check's verdict", async () => {
    let answer;
    const asked = new Promise((resolve) => {
      void page.route("**/diagnosis", (route) => {
        answer = () => route.fulfill({ json: DIAGNOSIS });
        resolve();
      });
    });
    await row(MISSING).check();
    await page.click("#diagnose-now");
    await asked;
    assert.ok(await page.isVisible("#diagnosis-progress"));
    assert.match(await text("#diagnosis-outcome"), /Looking/);
    await assertAccessible();
    await answer();
    await page.waitForSelector("#diagnosis-progress", { state: "hidden" });
    assert.equal(await text("#diagnosis-outcome"), "There is no port.");
    assert.deepEqual(await page.locator("#diagnosis-findings li").allTextContents(), [
      "It is not plugged in.",
      "The cable is broken.",
      "Plug it in.",
    ]);
    const checks = page.locator("#diagnosis-checks li");
    assert.deepEqual(await checks.locator(".verdict").allTextContents(), [
      "Fine",
      "Warning",
      "Wrong",
      "Not checked",
    ]);
    const shapes = await checks
      .locator("path")
      .evaluateAll((paths) => paths.map((path) => path.getAttribute("d")));
    assert.equal(new Set(shapes).size, 4);
    await assertAccessible();
  });

  test("the diagnosis keeps the focus, closes with Escape, and gives the focus back", async () => {
    assert.ok(await page.evaluate(() => document.activeElement.closest("#diagnosis") !== null));
    for (let k = 0; k < 4; ++k) {
      await page.keyboard.press("Tab");
      const outside = await page.evaluate(
        () => document.activeElement.closest("main, header.bar")?.tagName ?? "",
      );
      assert.equal(outside, "");
    }
    await page.keyboard.press("Escape");
    await page.waitForSelector("#diagnosis", { state: "hidden" });
    assert.equal(await page.evaluate(() => document.activeElement.id), "diagnose-now");
    await page.unroute("**/diagnosis");
  });

  test("a diagnosis that is closed while it runs is called off", async () => {
    await page.route("**/diagnosis", () => {});
    const asked = page.waitForRequest("**/diagnosis");
    const ended = page.waitForEvent("requestfailed");
    await page.keyboard.press("Enter");
    await asked;
    await page.keyboard.press("Escape");
    await ended;
    await page.unroute("**/diagnosis");
  });

  test("a diagnosis that is refused is told with its hint", async () => {
    await refuse("**/diagnosis", 503, "the gateway is shutting down", "start it again");
    await page.click("#diagnose-now");
    await until(() =>
      /Shutting|shutting/.test(document.getElementById("diagnosis-outcome").textContent),
    );
    assert.equal(await text("#diagnosis-hint"), "Start it again.");
    await page.click("#diagnosis-close");
    await accept("**/diagnosis", 503);
  });

  test("what the gateway itself finds wrong with a missing port is shown", async () => {
    const answer = page.waitForResponse("**/diagnosis");
    await page.click("#diagnose-now");
    const status = (await answer).status();
    await page.waitForSelector("#diagnosis-progress", { state: "hidden" });
    if (status === 404) {
      // A gateway that cannot diagnose.
      assert.match(await text("#diagnosis-outcome"), /This gateway cannot do that/);
      await accept("**/diagnosis", 404);
    } else {
      assert.equal(status, 200);
      assert.match(await text("#diagnosis-outcome"), new RegExp(MISSING));
      assert.match(await text("#diagnosis-checks li"), /The port exists.*Wrong/);
      assert.ok((await page.locator("#diagnosis-findings li").count()) > 1);
    }
    await page.keyboard.press("Escape");
  });
}

test("the browser had nothing to complain of", () => {
  assert.deepEqual(complaints, []);
});

async function main() {
  if (!base && !binary) throw new Error("set SWEEPCAST_BINARY, or give the address of a gateway");
  if (!base) {
    gateway = await Gateway.start(binary);
    base = gateway.url;
  }
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: BROWSER_ARGUMENTS,
    timeout: DEADLINE_MS,
  });
  let failed = 0;
  for (const { name, run } of tests) {
    try {
      await run();
      console.log(`ok    ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAIL  ${name}\n${error.stack ?? error}`);
    }
  }
  console.log(`cases: ${tests.length - failed} passed, ${failed} failed`);
  return failed === 0;
}

let ok = false;
try {
  ok = await main();
} catch (error) {
  console.log(`${error.stack ?? error}\ncases: 0 passed, 1 failed`);
} finally {
  await browser?.close();
  for (const each of [gateway, others]) {
    await each?.end().catch((error) => {
      console.log(String(error));
      ok = false;
    });
  }
}
process.exit(ok ? 0 : 1);
