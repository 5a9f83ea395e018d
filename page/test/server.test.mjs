// The page from the server, in a real browser.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { appendFileSync, copyFileSync, mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { ROOT, commandJson, seriousFindings, withPage } from './browser.mjs';

const EXAMPLE = `${ROOT}examples/five-wheel`;

/** Starts the server and gives its address. */
async function served(use, args = []) {
  const server = spawn(process.env.GROUSER_VIEW ?? 'grouser-view', args, { stdio: ['ignore', 'pipe', 'inherit'] });
  try {
    const address = await new Promise((resolve, reject) => {
      let text = '';
      server.stdout.on('data', (data) => {
        text += data;
        const found = text.match(/http:\S+/);
        if (found) resolve(found[0]);
      });
      server.on('exit', () => reject(new Error('the server ended')));
    });
    await use(address);
  } finally {
    server.kill();
  }
}

/** Are two answers the same, numbers to 1e-9? An optimum is flat: its place is known to the root of the precision of its height. */
function sameAnswer(mine, theirs, what) {
  if (typeof mine === 'number' && typeof theirs === 'number') {
    assert.ok(Math.abs(mine - theirs) <= (what.includes('most_') ? 1e-6 : 1e-9) * Math.max(1, Math.abs(mine)), `${what}: ${mine} and ${theirs}`);
  } else if (mine && theirs && typeof mine === 'object') {
    assert.deepEqual(Object.keys(mine), Object.keys(theirs), what);
    for (const key of Object.keys(mine)) sameAnswer(mine[key], theirs[key], `${what}, ${key}`);
  } else {
    assert.deepEqual(mine, theirs, what);
  }
}

test('every view loads from the server, which computes the same as the page', async () => {
  await served(async (address) => {
    const { origin } = new URL(address);
    await withPage({ address, allow: (to) => to.startsWith(origin) }, async (page) => {
      assert.equal(await page.evaluate(() => location.search), '', 'the token is gone from the address');
      const same = await page.evaluate(async () => {
        const { physics, server, views } = window.grouser;
        const state = views.get('explore').state;
        const soil = `format = 1\nname = "s"\nk_phi_kn_per_m_n2 = ${state.k_phi_kn_per_m_n2}\nk_c_kn_per_m_n1 = ${state.k_c_kn_per_m_n1}\nn = ${state.n}\ncohesion_kpa = 1.0\nphi_deg = 30.0\nk_shear_m = 0.025\nc_1 = 0.18\nc_2 = 0.32\n`;
        const out = [];
        for (const slip of [-0.3, 0, 0.2, 0.55, 0.9]) {
          const request = { call: 'wheel', soil, radius_m: 0.125, width_m: 0.1, load_n: 80, slip, profile: 0 };
          out.push([await physics.ask(request), await server.ask(request)]);
        }
        return out;
      });
      for (const [mine, theirs] of same) sameAnswer(mine, theirs, 'wheel');
      // every number that it answers
      const calls = await page.evaluate(async () => {
        const { physics, server } = window.grouser;
        const soil = `format = 1\nname = "s"\nk_phi_kn_per_m_n2 = 1528.4\nk_c_kn_per_m_n1 = 0.9\nn = 1.1\ncohesion_kpa = 1.0\nphi_deg = 30.0\nk_shear_m = 0.025\nc_1 = 0.18\nc_2 = 0.32\n`;
        const wheel = { soil, radius_m: 0.125, width_m: 0.1, load_n: 80 };
        const lugs = { grouser_count: 12, grouser_height_m: 0.01, grouser_thickness_m: 0.002 };
        const requests = [
          { call: 'catalogue' },
          { call: 'wheel', ...wheel, ...lugs, slip: 0.3, profile: 31 },
          { call: 'wheel', ...wheel, slip: 0.3, slope_deg: 8, slip_angle_deg: 10, profile: 0 },
          { call: 'wheel', ...wheel, load_n: 1e6, slip: 0.3, profile: 0 },
          ...[true, false].map((quick) => ({ call: 'curve', ...wheel, slip_from: 0, slip_to: 0.9, points: 19, quick, best: !quick })),
        ];
        const out = [];
        for (const request of requests) out.push([request.call, await physics.ask(request), await server.ask(request)]);
        return { out };
      });
      for (const [call, mine, theirs] of calls.out) sameAnswer(mine, theirs, call);
      const { points } = commandJson('grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0:0.9 --points 19');
      const ofServer = calls.out.find(([call, mine]) => call === 'curve' && mine.most_pull)[2];
      points.forEach((point, i) => sameAnswer(point.drawbar_pull_n, ofServer.drawbar_pull_n[i], `pull of point ${i}`));
      const theirs = commandJson('grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2');
      assert.ok(Math.abs(same[2][1].drawbar_pull_n - theirs.drawbar_pull_n) < 1e-9);
      assert.deepEqual(await seriousFindings(page), []);
      await page.click('a[data-view="run"]');
      await page.getByRole('button', { name: 'Drive the sandbox' }).click();
      await page.waitForSelector('.run-body:not([hidden])');
    });
  });
});

test('a log that the server estimates has the numbers of the command', async () => {
  const theirs = commandJson(`grouser estimate ${EXAMPLE}/log.mcap --robot ${EXAMPLE}/robot.toml`);
  await served(async (address) => {
    const { origin } = new URL(address);
    await withPage({ address, allow: (to) => to.startsWith(origin) }, async (page) => {
      await page.waitForFunction(() => document.querySelector('.run-status')?.textContent === 'the run has ended');
      const mine = await page.evaluate(() => {
        const { run } = window.grouser.views.get('run');
        return { medians: Object.fromEntries(run.wheels.map(({ name, median_slip }) => [name, median_slip])), end: run.time_s.at(-1) };
      });
      assert.ok(Math.abs(mine.end - theirs.duration_s) < 1e-9);
      for (const [name, { median }] of Object.entries(theirs.wheels)) {
        if (median === null) assert.equal(mine.medians[name], null, name);
        else assert.ok(Math.abs(mine.medians[name] - median) < 1e-9, `${name}: ${mine.medians[name]} and ${median}`);
      }
      assert.deepEqual(await seriousFindings(page), []);
    });
  }, [`${EXAMPLE}/log.mcap`, '--robot', `${EXAMPLE}/robot.toml`]);
});

test('a table that is still written is shown as it grows, and a chosen time keeps the picture', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'grouser-live-'));
  for (const name of ['robot.toml', 'columns.toml']) copyFileSync(`${EXAMPLE}/${name}`, join(folder, name));
  const [head, ...rows] = readFileSync(`${EXAMPLE}/log.csv`, 'utf8').trimEnd().split('\n');
  const log = join(folder, 'log.csv');
  writeFileSync(log, `${head}\n`);
  await served(async (address) => {
    const { origin } = new URL(address);
    await withPage({ address, allow: (to) => to.startsWith(origin) }, async (page) => {
      const write = (from, to) => appendFileSync(log, `${rows.slice(from, to).join('\n')}\n`);
      const last = () => page.evaluate(() => window.grouser.views.get('run').run.time_s.at(-1));
      const until = (time) => page.waitForFunction((t) => window.grouser.views.get('run').run?.time_s.at(-1) >= t, time);
      write(0, 500);
      // four rows are held back, and one whose time may still come
      await until(9.88);
      assert.ok(await last() < 9.99);
      await page.waitForFunction(() => document.querySelector('.player input')?.value > 9.8);
      // a part of a row waits for its rest
      appendFileSync(log, rows[500].slice(0, 12));
      appendFileSync(log, `${rows[500].slice(12)}\n`);
      write(501, 800);
      await until(15.88);
      await page.waitForFunction(() => document.querySelector('.player input')?.value > 15.8);
      assert.match(await page.locator('.wheels tbody tr').first().textContent(), /0\.\d+ ± 0\.\d+/);
      // a reader who chooses a time keeps it, and the picture
      await page.evaluate(() => {
        const scrub = document.querySelector('.player input');
        scrub.value = 12;
        scrub.dispatchEvent(new Event('input'));
      });
      const picture = () => page.evaluate(() => document.querySelector('.run .plot .lines').innerHTML);
      const before = await picture();
      write(800, 1200);
      await until(23.88);
      await page.waitForTimeout(600);
      assert.equal(await picture(), before);
      assert.equal(await page.locator('.player input').inputValue(), '12');
      await page.getByRole('button', { name: 'Live' }).click();
      await page.waitForFunction(() => document.querySelector('.player input')?.value > 23.8);
      assert.notEqual(await picture(), before);
      assert.deepEqual(await seriousFindings(page), []);
      // what is wrong with a row is said in words
      appendFileSync(log, 'x,y\n');
      await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.includes('line 1202'));
    });
  }, [log, '--robot', join(folder, 'robot.toml'), '--follow']);
});

test('an MCAP file that is still written is shown as it grows, to its end', async () => {
  const log = join(mkdtempSync(join(tmpdir(), 'grouser-live-')), 'log.mcap');
  const bytes = readFileSync(`${EXAMPLE}/log.mcap`);
  writeFileSync(log, '');
  await served(async (address) => {
    const { origin } = new URL(address);
    await withPage({ address, allow: (to) => to.startsWith(origin) }, async (page) => {
      const half = bytes.length >> 1;
      appendFileSync(log, bytes.subarray(0, half));
      await page.waitForFunction(() => window.grouser.views.get('run').run?.time_s.at(-1) >= 15);
      await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.startsWith('live to'));
      await page.waitForFunction(() => document.querySelector('.player input')?.value > 15);
      appendFileSync(log, bytes.subarray(half));
      await page.waitForFunction(() => document.querySelector('.run-status')?.textContent === 'the run has ended');
      const theirs = commandJson(`grouser estimate ${EXAMPLE}/log.mcap --robot ${EXAMPLE}/robot.toml --online`);
      const run = await page.evaluate(() => {
        const { time_s, wheels } = window.grouser.views.get('run').run;
        return { end: time_s.at(-1), wheels: wheels.map(({ name, median_slip }) => [name, median_slip]) };
      });
      assert.ok(Math.abs(run.end - theirs.duration_s) < 1e-9);
      for (const [name, median] of run.wheels) assert.ok(Math.abs(median - theirs.wheels[name].median) < 1e-9, name);
    });
  }, [log, '--robot', `${EXAMPLE}/robot.toml`, '--follow']);
});
