// The run view in a real browser: recorded logs, drives, one cursor of time.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { assertSame, boxOf, commandJson, ROOT, seriousFindings, withPage } from './browser.mjs';

const EXAMPLE = `${ROOT}examples/five-wheel`;
const GROUSER = process.env.GROUSER ?? 'grouser';
const folder = mkdtempSync(join(tmpdir(), 'grouser-run-'));
/** The run that is shown; numbers that are missing are null. */
const runOf = (page) => page.evaluate(() => JSON.parse(JSON.stringify(window.grouser.views.get('run').run, (_, value) => (value instanceof Float64Array ? [...value] : value))));
const shown = (page) => page.waitForSelector('.run-body:not([hidden])');

let table = null;
/** The rows of `grouser estimate -o`, by wheel and time. */
function estimates() {
  if (!table) {
    const path = join(folder, 'estimates.csv');
    execFileSync(GROUSER, ['estimate', `${EXAMPLE}/log.csv`, '--robot', `${EXAMPLE}/robot.toml`, '-o', path], { stdio: 'ignore' });
    const rows = readFileSync(path, 'utf8').trimEnd().split('\n').slice(1).map((line) => line.split(','));
    table = { path, rows };
  }
  return table;
}

test('a log dropped with its robot file gives the rows of the command', async () => {
  const { rows } = estimates();
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', [`${EXAMPLE}/log.csv`, `${EXAMPLE}/robot.toml`, `${EXAMPLE}/columns.toml`]);
    await shown(page);
    await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.includes('estimated in'));
    const run = await runOf(page);
    const places = new Map(run.time_s.map((time, i) => [time, i]));
    let compared = 0;
    for (const [time, name, slip, sigma] of rows) {
      const i = places.get(Number(time));
      assert.notEqual(i, undefined, `time ${time}`);
      const wheel = run.wheels.find((one) => one.name === name);
      assertSame(wheel.slip[i], slip === '' ? null : Number(slip), `slip of ${name} at ${time} s`);
      assertSame(wheel.slip_sigma[i], sigma === '' ? null : Number(sigma), `sigma of ${name} at ${time} s`);
      compared += 1;
    }
    assert.equal(compared, rows.length);
    assert.ok(compared > 5000);
    assert.ok(run.distance_m > 5);
  });
});

test('a log that comes alone is asked about: two numbers, its slips, and the file that gives the same by the command', async () => {
  const saved = join(folder, 'robot.toml');
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', `${EXAMPLE}/log.csv`);
    await page.waitForSelector('.draft');
    const go = page.getByRole('button', { name: 'Estimate slip' });
    assert.ok((await page.textContent('.draft')).includes('front_left'));
    assert.equal(await page.locator('.draft input').count(), 2);
    assert.ok(await go.isDisabled(), 'a radius is open');
    await page.fill('#draft-radius_m', '0.1');
    assert.ok(await go.isDisabled(), 'ticks are open');
    await page.fill('#draft-ticks_per_turn', '960');
    assert.deepEqual(await seriousFindings(page), []);
    const started = Date.now();
    await go.click();
    await shown(page);
    await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.includes('estimated in'));
    assert.ok(Date.now() - started < 60000);
    const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save robot.toml' }).click()]);
    await file.saveAs(saved);
    const run = await runOf(page);
    const table = join(folder, 'alone.csv');
    try {
      execFileSync(GROUSER, ['estimate', `${EXAMPLE}/log.csv`, '--robot', saved, '-o', table], { stdio: 'ignore' });
    } catch ({ status }) {
      // places are round numbers: a doubt is right
      assert.equal(status, 3);
    }
    const rows = readFileSync(table, 'utf8').trimEnd().split('\n').slice(1).map((line) => line.split(','));
    const places = new Map(run.time_s.map((time, i) => [time, i]));
    for (const [time, name, slip] of rows) {
      assertSame(run.wheels.find((one) => one.name === name).slip[places.get(Number(time))], slip === '' ? null : Number(slip), `slip of ${name} at ${time} s`);
    }
    assert.ok(rows.some(([, , slip]) => Number(slip) > 0.1));
  });
});

/** An MCAP file as the files of a split recording, each whole: its chunks are dealt out in their order. */
function splitRecording(bytes, count) {
  const magic = bytes.subarray(0, 8);
  const records = [];
  for (let at = 8; at < bytes.length - 8;) {
    const end = at + 9 + Number(bytes.readBigUInt64LE(at + 1));
    records.push({ op: bytes[at], bytes: bytes.subarray(at, end) });
    at = end;
  }
  const of = (...ops) => records.filter(({ op }) => ops.includes(op)).map((record) => record.bytes);
  const record = (op, length) => Buffer.concat([Buffer.from([op, length, 0, 0, 0, 0, 0, 0, 0]), Buffer.alloc(length)]);
  const chunks = of(6);
  assert.ok(chunks.length >= 2 * count, `${chunks.length} chunks`);
  const header = [...of(1), ...of(3), ...of(4)];
  return Array.from({ length: count }, (_, i) => Buffer.concat([magic, ...header, ...chunks.filter((_chunk, k) => Math.floor((k * count) / chunks.length) === i), record(15, 4), record(2, 20), magic]));
}

test('the files of a split recording are one log: chosen, and dropped with their folder', async () => {
  const parts = splitRecording(readFileSync(`${EXAMPLE}/log.mcap`), 11).map((buffer, i) => ({ name: `run_${i}.mcap`, mimeType: 'application/octet-stream', buffer }));
  const robot = { name: 'robot.toml', mimeType: 'text/plain', buffer: readFileSync(`${EXAMPLE}/robot.toml`) };
  const ended = (page) => page.waitForFunction(() => document.querySelector('.run-status')?.textContent.includes('estimated in'));
  const run = (page) => page.evaluate(() => {
    const { time_s, wheels } = window.grouser.views.get('run').run;
    return { time_s: [...time_s], slips: wheels.map(({ slip }) => [...slip].map(String)) };
  });
  const whole = await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', [`${EXAMPLE}/log.mcap`, `${EXAMPLE}/robot.toml`]);
    await ended(page);
    return run(page);
  });
  assert.ok(whole.time_s.length > 1000);
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', [robot, ...parts]);
    await ended(page);
    assert.match(await page.locator('.file-list').textContent(), /^robot: robot\.toml · log: run_0\.mcap and 10 more$/);
    assert.deepEqual(await run(page), whole);
  });
  await withPage({ hash: '#run' }, async (page) => {
    const files = [robot, ...parts, { name: 'metadata.yaml', buffer: Buffer.from('version: 9') }].map(({ name, buffer }) => [name, buffer.toString('base64')]);
    // what a browser hands over for a folder, which comes in pieces
    await page.evaluate((all) => {
      const entries = all.map(([name, text]) => ({ isFile: true, isDirectory: false, file: (take) => take(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name)) }));
      const pieces = [entries.slice(0, 5), entries.slice(5), []];
      const folder = { isFile: false, isDirectory: true, createReader: () => ({ readEntries: (take) => take(pieces.shift()) }) };
      const drop = new Event('drop', { bubbles: true, cancelable: true });
      drop.dataTransfer = { items: [{ webkitGetAsEntry: () => folder }], files: [] };
      document.querySelector('.run').dispatchEvent(drop);
    }, files);
    await ended(page);
    assert.deepEqual(await run(page), whole);
  });
});

test('the table of estimate opens alone, is scrubbed and masked at rest', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', estimates().path);
    await shown(page);
    assert.ok(!(await page.locator('.map').isVisible()), 'a table without a place has no map');
    const at = (time) => page.evaluate((t) => {
      const scrub = document.querySelector('.player input');
      scrub.value = t;
      scrub.dispatchEvent(new Event('input'));
      return [...document.querySelectorAll('.wheels tbody tr')].map((row) => row.textContent);
    }, time);
    const first = await at(0.5);
    assert.match(first[0], /–.*(Standstill|–)/);
    const driving = await at(18);
    assert.match(driving[0], /0\.\d+ ± 0\.\d+.*Driving.*Ok/);
    // the cursor is one for all
    const lines = await page.evaluate(() => [...document.querySelectorAll('.chart:not([hidden]) .cursor-line')].length);
    assert.ok(lines >= 1);
    assert.ok(await page.locator('.span.rest').count() > 0, 'times at rest are shaded');
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('playing moves the cursor, and a click on the chart sets it', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', estimates().path);
    await shown(page);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction(() => Number(document.querySelector('.player input')?.value) > 0.5);
    await page.getByRole('button', { name: 'Pause' }).click();
    const box = await boxOf(page.locator('.run .plot').first());
    await page.mouse.click(box.x + box.width * 0.8, box.y + box.height * 0.5);
    await page.waitForFunction(() => Number(document.querySelector('.player input')?.value) > 25);
    await page.selectOption('select[aria-label="Time shown"]', '10');
    await page.getByRole('button', { name: 'One chart for each wheel' }).click();
    assert.equal(await page.locator('.run-more .charts .chart:not([hidden])').count(), 5);
  });
});

test('a log of two hours is there in seconds, and is scrubbed while it is estimated', async (t) => {
  // the example over and over, at 100 Hz
  const [head, ...rows] = readFileSync(`${EXAMPLE}/log.csv`, 'utf8').trimEnd().split('\n');
  const cells = rows.map((row) => row.split(',').map(Number));
  const counts = cells.map((row) => row.slice(1, 6));
  for (let i = 1; i < counts.length; i += 1) {
    counts[i] = counts[i].map((count, wheel) => counts[i - 1][wheel] + ((((count - cells[i - 1][wheel + 1]) % 65536) + 98304) % 65536) - 32768);
  }
  const lap = counts.at(-1).map((count, wheel) => count - counts[0][wheel]);
  const lines = [head];
  for (let k = 0; k < 720000; k += 1) {
    const i = k % rows.length;
    const laps = Math.floor(k / rows.length);
    lines.push(`${10 * k},${counts[i].map((count, wheel) => (((count + laps * lap[wheel]) % 65536) + 65536) % 65536).join()},${cells[i][6]}`);
  }
  const path = join(mkdtempSync(join(tmpdir(), 'grouser-long-')), 'log.csv');
  writeFileSync(path, `${lines.join('\n')}\n`);
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', [path, `${EXAMPLE}/robot.toml`, `${EXAMPLE}/columns.toml`]);
    await shown(page);
    const seconds = await page.evaluate(() => window.grouser.views.get('run').timings.overview / 1e3);
    t.diagnostic(`the whole log's rim speeds after ${seconds.toFixed(2)} s`);
    assert.match(await page.locator('.now').textContent(), /2:00:00$/);
    await page.waitForFunction(() => window.grouser.views.get('run').run.time_s.length > 40000);
    const found = await page.evaluate(async () => {
      const { run } = window.grouser.views.get('run');
      const scrub = document.querySelector('.player input');
      const times = [];
      const read = (time) => {
        scrub.value = time;
        scrub.dispatchEvent(new Event('input'));
        document.body.getBoundingClientRect(); // lays out
        return document.querySelector('.wheels tbody tr').textContent;
      };
      for (let i = 0; i < 60; i += 1) {
        const start = performance.now();
        read(120 * i);
        times.push(performance.now() - start);
        await new Promise(requestAnimationFrame);
      }
      return { growing: run.is_growing, late: read(7000), early: read(9), rims: run.overview.rims[0].length, median: times.sort((a, b) => a - b)[30], p95: times[56] };
    });
    t.diagnostic(`a scrub p95 ${found.p95.toFixed(1)} ms while it is estimated`);
    assert.ok(found.growing && found.rims > 4000);
    assert.match(found.early, /0\.\d+ ± 0\.\d+.*Ok/, 'estimated');
    assert.match(found.late, /^\S*–––$/, 'not estimated yet');
    assert.ok(found.median < 333, `${found.median} ms`);
    await page.getByRole('button', { name: 'Stop' }).click();
    await page.waitForFunction(() => document.querySelector('.run-status')?.textContent === 'stopped');
  });
});

test('scrubbing keeps thirty frames a second', async (t) => {
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', estimates().path);
    await shown(page);
    const times = await page.evaluate(async () => {
      const scrub = document.querySelector('.player input');
      const out = [];
      for (let i = 0; i < 90; i += 1) {
        const start = performance.now();
        scrub.value = (40 * i) / 90;
        scrub.dispatchEvent(new Event('input'));
        document.body.getBoundingClientRect(); // lays out
        out.push(performance.now() - start);
        await new Promise(requestAnimationFrame);
      }
      return out.sort((a, b) => a - b);
    });
    t.diagnostic(`a scrub p95 ${times[Math.floor(0.95 * times.length)].toFixed(1)} ms of 10 005 rows`);
    assert.ok(times[45] < 333, `${times[45]} ms`);
  });
});

test('a drive in the page is the drive of the command', async (t) => {
  const theirs = commandJson(`grouser drive ${ROOT}examples/scenarios/sandbox.toml`).runs.find(({ controller }) => controller === 'controller');
  await withPage({ hash: '#run' }, async (page) => {
    await page.getByRole('button', { name: 'Drive the sandbox' }).click();
    await shown(page);
    const mine = await runOf(page);
    assert.equal(mine.outcome, theirs.outcome);
    assert.equal(mine.decisions.length, theirs.decisions.length);
    // a drive is chaotic in the last digits of sines, which the browser computes by other polynomials
    for (const key of ['distance_m', 'duration_s', 'energy_j', 'slip_rmse']) assertSame(mine[key], theirs[key], key, 0.02);
    const seconds = await page.evaluate(() => window.grouser.views.get('run').timings.compute);
    t.diagnostic(`${mine.duration_s.toFixed(1)} s driven in ${seconds.toFixed(2)} s: ${(mine.duration_s / seconds).toFixed(1)} times real time`);
    assert.ok(await page.locator('.way path').count() > 2, 'the way has colours');
    assert.ok(await page.locator('.track .rut').count() > 0, 'the wheels leave ruts');
    // level ground: the loads carry the weight, within what the suspension adds for a moment
    const loads = await page.evaluate(() => {
      const { run } = window.grouser.views.get('run');
      const sums = [...run.time_s].map((_, i) => run.wheels.reduce((sum, wheel) => sum + wheel.load_n[i], 0)).slice(20).sort((a, b) => a - b);
      return { median: sums[sums.length >> 1], wheels: document.querySelectorAll('.wheel-from-above').length, names: document.querySelector('.robot-view').getAttribute('aria-label') };
    });
    assert.equal(loads.wheels, mine.wheels.length);
    assert.match(loads.names, /front_left: .* N along/);
    t.diagnostic(`median of the loads' sum ${loads.median.toFixed(1)} N`);
    const masses = [...readFileSync(`${ROOT}examples/robots/five-wheel.toml`, 'utf8').matchAll(/^\s*mass_kg\s*=\s*([\d.]+)/gm)].map(([, mass]) => Number(mass));
    const weight = 9.80665 * masses.reduce((sum, mass) => sum + mass, 0);
    assert.ok(Math.abs(loads.median - weight) < 0.02 * weight, `${loads.median} N carry ${weight} N`);
    assert.deepEqual(await seriousFindings(page), []);
    assert.ok(!(await page.locator('main').textContent()).includes('NaN'));
  });
});

test('files that are no runs are refused in words', async () => {
  const file = (name, text) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
  const cases = [
    [[file('a.csv', 'time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg\n0,a,much,,,Ok,\n')], /line 2, column slip: “much” is not a number/],
    [[file('b.csv', 'time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg\n1,a,,,,Ok,\n0,a,,,,Ok,\n')], /before/],
    [[file('c.csv', 'time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg\n')], /no rows/],
    [[file('d.mcap', 'no recording')], /d\.mcap: holds a header and no data/],
    [[file('log.csv', 'a,b\n1,2\n'), file('robot.toml', 'format = 1\n[[wheel]]\nradius_m = "x"\n')], /robot\.toml:1:1: the file has no key `name`/],
    [[...['scenarios/plan-and-learn', 'robots/five-wheel'].map((name) => file(`${name.split('/')[1]}.toml`, readFileSync(`${ROOT}examples/${name}.toml`, 'utf8')))], /plans its way, which the page does not/],
    [[file('<img src=x onerror=alert(1)>.csv', 'time_s,wheel,slip,\n')], /no column slip_sigma/],
  ];
  for (const [files, expected] of cases) {
    await withPage({ hash: '#run' }, async (page) => {
      await page.setInputFiles('#run-files', files);
      await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.length > 5 && !document.querySelector('.run-status')?.textContent.endsWith('…'));
      assert.match(await page.locator('.run-status').textContent(), expected);
      assert.equal(await page.locator('img').count(), 0);
    });
  }
});

test('hostile names of wheels stay text', async () => {
  const name = '"<img src=x onerror=""document.title=1"">"';
  const rows = Array.from({ length: 30 }, (_, i) => `${i / 10},${name},0.${i + 10},0.01,Driving,Ok,`);
  await withPage({ hash: '#run' }, async (page) => {
    await page.setInputFiles('#run-files', { name: 'x.csv', mimeType: 'text/csv', buffer: Buffer.from(`time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg\n${rows.join('\n')}\n`) });
    await shown(page);
    assert.equal(await page.locator('img').count(), 0);
    assert.match(await page.locator('.wheels tbody').textContent(), /<img src=x onerror="document\.title=1">/);
  });
});

test('an exported page opens with its run, from a file', async () => {
  const view = process.env.GROUSER_VIEW ?? 'grouser-view';
  const out = join(folder, 'run.html');
  execFileSync(view, ['--export', out, '--', estimates().path]);
  assert.ok(statSync(out).size < 1_500_000, `${statSync(out).size} bytes`);
  await withPage({ address: `file://${out}`, width: 390, height: 844, dark: true }, async (page) => {
    await shown(page);
    assert.equal((await runOf(page)).wheels.length, 5);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('a report of the command opens from a file: drives on one map, a log, a front', async () => {
  const report = (name, line) => {
    const out = join(folder, name);
    execFileSync('bash', ['-c', `"${GROUSER}" ${line} --report "${out}"`], { cwd: ROOT, stdio: 'ignore' });
    assert.ok(statSync(out).size < 1_500_000, `${name}: ${statSync(out).size} bytes`);
    return `file://${out}`;
  };
  const drives = report('drives.html', 'drive examples/scenarios/soft-patch.toml --compare open-loop,controller');
  for (const options of [{ width: 390, height: 844, dark: true }, {}]) {
    await withPage({ address: drives, ...options }, async (page) => {
      await shown(page);
      assert.equal((await runOf(page)).controller, 'controller');
      assert.equal(await page.locator('.other-way').count(), 1);
      assert.ok(await page.locator('.relief').getAttribute('href').then((href) => href.startsWith('data:image/png')));
      assert.ok(await page.locator('.contour-label').count() > 0, 'a contour has its height');
      assert.match(await page.locator('.soil-name').textContent(), /\S/);
      assert.match(await page.locator('[aria-label="Provenance"]').textContent(), /SHA-256/);
      await page.getByRole('button', { name: 'open-loop' }).click();
      assert.equal((await runOf(page)).controller, 'open-loop');
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= (options.width ?? 1400));
      assert.deepEqual(await seriousFindings(page), []);
      assert.ok(!(await page.locator('main').textContent()).includes('NaN'));
    });
  }
  const log = report('log.html', 'estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml');
  await withPage({ address: log }, async (page) => {
    await shown(page);
    assert.equal((await runOf(page)).wheels.length, 5);
    assert.deepEqual(await seriousFindings(page), []);
  });
  const learnt = report('learnt.html', 'drive examples/scenarios/unknown-soil.toml');
  await withPage({ address: learnt }, async (page) => {
    await shown(page);
    const { soil } = await runOf(page);
    const row = await page.locator('.learnt tbody tr').last().textContent();
    assert.match(row, new RegExp(`friction angle${soil.phi_deg.toPrecision(3)}°${soil.phi_low_deg.toPrecision(3)}° to`));
    assert.deepEqual(await seriousFindings(page), []);
  });
  const front = report('front.html', 'optimize examples/problems/pull-against-torque.toml');
  await withPage({ address: front, width: 390, height: 844 }, async (page) => {
    assert.ok(await page.locator('.front-dot').count() > 10);
    assert.ok(!(await page.getByRole('button', { name: 'Solve' }).isVisible()));
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('a report that holds no run is refused in words', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    const file = { name: 'bad.json', mimeType: 'application/json', buffer: Buffer.from('{"runs": [{"time_s": [0, 1], "wheels": [{"name": "a", "slip": [0]}]}]}') };
    await page.setInputFiles('#run-files', file);
    await page.waitForFunction(() => document.querySelector('.run-status')?.textContent.includes('holds no run'));
  });
});
