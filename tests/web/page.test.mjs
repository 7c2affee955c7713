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
const DEADLINE_MS = 20_000;
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
let base = process.argv[2] ?? process.env.SWEEPCAST_URL;
let browser;
let page;
const complaints = [];
const tests = [];
const test = (name, run) => tests.push({ name, run });

// The page in a window of this kind, connected.
async function open(options, path = "") {
  await page?.context().close();
  const context = await browser.newContext(options);
  page = await context.newPage();
  page.setDefaultTimeout(DEADLINE_MS);
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
  });
  await page.goto(base + path);
  await until(() => window.sweepcast?.connected);
}

const until = (condition, argument) => page.waitForFunction(condition, argument);
const untilState = (state) => until((wanted) => window.sweepcast.state === wanted, state);
const text = (selector) => page.textContent(selector);
const view = () => page.evaluate(() => window.sweepcast.view);
const enabled = async (id) => (await page.getAttribute(id, "aria-disabled")) === "false";

// Brings the lidar to scanning with the page's own button, if it does not scan yet.
async function startScanning() {
  await until(() => ["IDLE", "SCANNING"].includes(window.sweepcast.state));
  if ((await page.evaluate(() => window.sweepcast.state)) === "IDLE") await page.click("#start");
  await untilState("SCANNING");
  await until(() => window.sweepcast.points > 50 && !window.sweepcast.stale);
}

async function stopScanning() {
  await page.click("#stop");
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

// The middle of the drawing, on the page and on the drawing.
async function middle() {
  const box = await page.locator("#overlay").boundingBox();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width };
}

// A point that can be pointed at: clear of the edges, where buttons and readout are, and of the lidar.
const clearPoint = () =>
  page.evaluate(() => {
    const { width, height } = window.sweepcast.view;
    for (let k = 0; k < window.sweepcast.points; ++k) {
      const point = window.sweepcast.point(k);
      const inside = point.x > 80 && point.x < width - 80 && point.y > 80 && point.y < height - 180;
      const away = Math.hypot(point.x - width / 2, point.y - height / 2);
      if (inside && away > 40) return point;
    }
    return undefined;
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
  await until(() => Number(document.getElementById("rpm").textContent) > 60);
  await until(() => Number(document.getElementById("sweeps-per-second").textContent) > 1);
  assert.match(await text("#state-word"), /Scanning/);
  assert.match(await text("#summary"), /Nearest obstacle \d+\.\d+ m at \d+°/);
});

test("start is off and stop is on while it scans", async () => {
  assert.equal(await enabled("#start"), false);
  assert.equal(await enabled("#stop"), true);
});

for (const scheme of ["light", "dark"]) {
  test(`every point is drawn where it belongs, in its colour, and nothing else (${scheme})`, async () => {
    await page.emulateMedia({ colorScheme: scheme });
    const before = await page.evaluate(() => window.sweepcast.sequence);
    await until((sequence) => window.sweepcast.sequence > sequence + 1, before);
    await assertDrawn();
  });

  test(`the page has no accessibility fault that axe finds (${scheme})`, async () => {
    const { violations } = await new AxeBuilder({ page }).analyze();
    assert.deepEqual(
      violations.map(({ id, nodes }) => [id, nodes.map(({ target }) => target).join()]),
      [],
    );
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
  const point = await clearPoint();
  const { scale } = await view();
  const box = await page.locator("#overlay").boundingBox();
  await page.mouse.move(box.x + point.x, box.y + point.y);
  await page.waitForSelector("#readout:not([hidden])");
  const readout = await text("#readout");
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

// Whether the overlay looks different a few pictures later. The pointer is elsewhere, so only the sweep line
// can have moved.
const overlayMoves = () =>
  page.evaluate(async () => {
    const canvas = document.getElementById("overlay");
    const look = () =>
      canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.join("");
    const pictures = (count) =>
      new Promise((resolve) => {
        const next = () => (count-- > 0 ? requestAnimationFrame(next) : resolve());
        next();
      });
    await pictures(2);
    const before = look();
    await pictures(5);
    return look() !== before;
  });

test("the sweep line turns, unless less motion is wished for", async () => {
  await page.mouse.move(1270, 790);
  await page.waitForSelector("#readout", { state: "hidden" });
  assert.equal(await overlayMoves(), true);
  await page.emulateMedia({ reducedMotion: "reduce" });
  assert.equal(await overlayMoves(), false);
  await page.emulateMedia({ reducedMotion: "no-preference" });
});

test("stop ends the scan; the last sweep stays, marked as old", async () => {
  await stopScanning();
  assert.match(await text("#state-word"), /motor off/);
  await until(() => document.getElementById("stage").classList.contains("stale"));
  await until(() => getComputedStyle(document.getElementById("points")).opacity < 0.5);
  assert.match(await text("#stage-note"), /Last sweep/);
  assert.ok((await page.evaluate(() => window.sweepcast.points)) > 50);
  assert.equal(await enabled("#start"), true);
  assert.equal(await enabled("#stop"), false);
});

test("a picked mode is the one it starts in", async () => {
  const modes = await page.locator("#mode-picker option").allTextContents();
  assert.ok(modes.length > 1, `modes: ${modes}`);
  const current = await page.inputValue("#mode-picker");
  const other = modes.find((mode) => mode !== current);
  await page.selectOption("#mode-picker", other);
  const request = page.waitForRequest(
    (each) => each.method() === "POST" && each.url().endsWith("/start"),
  );
  await page.click("#start");
  assert.deepEqual((await request).postDataJSON(), { mode: other });
  await untilState("SCANNING");
  assert.equal(await page.inputValue("#mode-picker"), other);
});

test("while it scans another mode can be switched to", async () => {
  const current = await page.inputValue("#mode-picker");
  const modes = await page.locator("#mode-picker option").allTextContents();
  const other = modes.find((mode) => mode !== current);
  await page.selectOption("#mode-picker", other);
  assert.equal(await text("#start"), "Switch mode");
  await page.click("#start");
  await until(() => document.getElementById("start").textContent === "Start");
  await untilState("SCANNING");
  assert.equal(await page.inputValue("#mode-picker"), other);
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
  await page.click("#reset");
  assert.equal((await answer).status(), 200);
  assert.ok((await page.evaluate(() => window.wordsSeen)).includes("Identifying"));
  await until(() => document.getElementById("reset").textContent === "Reset");
  await startScanning();
});

test("what the gateway refuses is told with its hint, and can be dismissed", async () => {
  await page.route("**/stop", (route) =>
    route.fulfill({
      status: 409,
      json: { error: { code: "busy", message: "the motor is stuck", hint: "free it" } },
    }),
  );
  await page.click("#stop");
  await page.waitForSelector("#trouble:not([hidden])");
  assert.equal(await text("#trouble-message"), "the motor is stuck");
  assert.equal(await text("#trouble-hint"), "free it");
  await page.click("#trouble-dismiss");
  assert.ok(await page.isHidden("#trouble"));
  await page.unroute("**/stop");
  // The browser reports a refused request on its console; that one was meant.
  const meant = complaints.findIndex((complaint) => complaint.includes("409"));
  if (meant >= 0) complaints.splice(meant, 1);
});

test("on a phone the drawing is on top, nothing is cut off, and targets are large", async () => {
  await open(PHONE);
  await startScanning();
  const layout = await page.evaluate(() => ({
    overflow: document.documentElement.scrollWidth - innerWidth,
    drawingEnds: document.getElementById("stage").getBoundingClientRect().bottom,
    panelBegins: document.querySelector(".panel").getBoundingClientRect().top,
    small: [...document.querySelectorAll("button, select, .colour label")]
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
    await gateway.kill();
    await page.waitForSelector("#banner:not([hidden])");
    await until(() => /in \d+ s|now/.test(document.getElementById("banner-countdown").textContent));
    await until(() => document.getElementById("stage").classList.contains("stale"));
    assert.equal(await page.evaluate(() => window.sweepcast.connected), false);
    assert.match(await text("#link"), /Not connected/);
    assert.equal(await text("#state-word"), "Unknown");
    assert.equal(await enabled("#start"), false);
    assert.equal(await enabled("#stop"), false);
  });

  test("the page comes back by itself with the gateway", async () => {
    gateway = await Gateway.start(binary, gateway.address);
    await until(() => window.sweepcast.connected);
    await page.waitForSelector("#banner", { state: "hidden" });
    await startScanning();
    await assertDrawn();
    // Refused attempts were reported on the browser's console meanwhile, as they should be.
    complaints.length = 0;
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
  console.log(`${tests.length - failed} passed, ${failed} failed`);
  return failed === 0;
}

let ok = false;
try {
  ok = await main();
} catch (error) {
  console.log(`${error.stack ?? error}\n0 passed, 1 failed`);
} finally {
  await browser?.close();
  await gateway?.kill();
}
process.exit(ok ? 0 : 1);
