// A browser with the page in it: every error of the console and every request elsewhere fails the test.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before } from 'node:test';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const here = fileURLToPath(new URL('.', import.meta.url));
/** The page as one HTML file. */
export const PAGE = `file://${process.env.GROUSER_PAGE ?? `${here}../dist/grouser.html`}`;
/** The folder of the project. */
export const ROOT = fileURLToPath(new URL('../..', import.meta.url));
const GROUSER = process.env.GROUSER ?? 'grouser';
const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** The longest wait for anything: a loaded machine is slow, and only what never comes fails. */
const WAIT_MS = 240000;

let browser;
before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'],
  });
});
after(() => browser?.close());

/** Opens the page at a part of its address and hands it to `use`. */
export async function withPage(options, use) {
  const { hash = '', width = 1400, height = 900, dark = false, address = PAGE, allow = () => false } = options;
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(WAIT_MS);
  const errors = [];
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && errors.push(message.text()));
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('request', (request) => {
    const to = request.url();
    if (!to.startsWith('file:') && !to.startsWith('data:') && !to.startsWith('blob:') && !allow(to)) errors.push(`request to ${to}`);
  });
  try {
    await page.goto(address + hash);
    await page.waitForSelector('[data-ready]', { state: 'attached' });
    const result = await use(page);
    assert.deepEqual(errors, [], 'errors of the console');
    return result;
  } finally {
    await context.close();
  }
}

/** Waits until faces are there, and what is drawn in a frame, or after it has its width, is drawn. */
export async function settled(page) {
  await page.evaluate(async () => {
    await document.fonts.ready;
    for (let i = 0; i < 3; i += 1) await new Promise(requestAnimationFrame);
  });
}

/** Gives the window another size, and waits until the page has it. */
export async function resized(page, width, height) {
  await page.setViewportSize({ width, height });
  await page.waitForFunction(([w, h]) => innerWidth === w && innerHeight === h, [width, height]);
  await settled(page);
}

/** Serious findings of axe on what the page shows. */
export async function seriousFindings(page) {
  // the page's policy lets no script in; the test's is put in by the debugger's way
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run({ resultTypes: ['violations'] }));
  return violations.filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map((node) => node.html.slice(0, 160)).join(' | ')}`);
}

/** The JSON that a shell line with `grouser` in it prints; exit codes 0, 1 and 3 have an object. */
export function commandJson(script, folder = ROOT) {
  const line = `${script.trimEnd()} --json\n`.replaceAll(/^grouser /gm, `"${GROUSER}" `);
  try {
    return JSON.parse(execFileSync('bash', ['-c', line], { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));
  } catch (error) {
    if ([1, 3].includes(error.status)) return JSON.parse(error.stdout);
    throw error;
  }
}

/** Are two numbers (or null) the same to `tolerance`, relative to the larger and to one? */
export function assertSame(mine, theirs, what, tolerance = 1e-9) {
  if (mine === null || theirs === null || mine === undefined || theirs === undefined) {
    assert.equal(mine ?? null, theirs ?? null, what);
    return;
  }
  assert.ok(Math.abs(mine - theirs) <= tolerance * Math.max(1, Math.abs(theirs)), `${what}: ${mine} and ${theirs}`);
}

/** Random numbers from a seed, in [0, 1): mulberry32. */
export function random(seed) {
  let a = seed >>> 0;
  return () => {
    a = (a + 0x6d2b79f5) >>> 0;
    let t = Math.imul(a ^ (a >>> 15), 1 | a);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** The place of an element; what is drawn anew at the moment has none for an instant. */
export async function boxOf(locator) {
  for (;;) {
    const box = await locator.boundingBox();
    if (box) return box;
  }
}
