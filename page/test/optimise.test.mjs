// The optimiser in a real browser, held to the command.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { assertSame, boxOf, commandJson, ROOT, seriousFindings, withPage } from './browser.mjs';

const answerOf = (page) => page.evaluate(() => window.grouser.views.get('optimise').answer);

async function solve(page, name) {
  await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
  await page.selectOption('select[aria-label="Example"]', name);
  await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
  await page.getByRole('button', { name: 'Solve' }).click();
  await page.waitForSelector('.optimise .hero');
}

test('a compromise and its multipliers are those of the command', async () => {
  const theirs = commandJson(`grouser optimize ${ROOT}examples/problems/dry-sand-wheel.toml`);
  await withPage({ hash: '#optimise' }, async (page) => {
    await solve(page, 'dry-sand-wheel');
    const mine = await answerOf(page);
    assert.equal(mine.status, theirs.status);
    // the solver ends where its conditions hold to 1e-8 or so, by another way in the last digits
    for (const [name, value] of Object.entries(theirs.x)) assertSame(mine.x[name], value, name, 1e-6);
    for (const [name, share] of Object.entries(theirs.objective_multipliers)) assertSame(mine.objective_multipliers[name], share, name, 1e-4);
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('a front is shown in linked pictures, and a compromise goes on to the explorer', async (t) => {
  const theirs = commandJson(`grouser optimize ${ROOT}examples/problems/pull-against-torque.toml`);
  await withPage({ hash: '#optimise' }, async (page) => {
    await solve(page, 'pull-against-torque');
    const mine = await answerOf(page);
    t.diagnostic(await page.locator('.problem .run-status').textContent());
    assert.equal(mine.front.length, theirs.front.length);
    const ends = (front, name) => [Math.min, Math.max].map((of) => of(...front.map(({ objectives }) => objectives[name])));
    for (const { name } of mine.objectives) {
      const [a, b] = [ends(mine.front, name), ends(theirs.front, name)];
      a.forEach((value, i) => assertSame(value, b[i], `end of ${name}`, 0.02));
    }
    await page.locator('.front-dot').nth(3).click();
    assert.equal(await page.locator('.compromise.is-chosen').count(), 1);
    assert.deepEqual(await seriousFindings(page), []);
    const radius = mine.front[3].x.radius_m;
    await page.getByRole('button', { name: 'Explore this wheel' }).click();
    await page.waitForFunction((r) => Math.abs(window.grouser.views.get('explore').state.radius_m - r) < 1e-5, radius);
    assert.equal(await page.evaluate(() => window.grouser.views.get('explore').state.soil), 'sandy-loam');
  });
});

test('a front of three objectives turns in space and is linked with the other pictures', async () => {
  await withPage({ hash: '#optimise' }, async (page) => {
    await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
    const text = await page.locator('.problem textarea').inputValue();
    await page.fill('.problem textarea', text.replace('torque    = "torque_nm"', 'torque = "torque_nm"\nsinking = "sinkage_m"').replace('population = 60', 'population = 24').replace('generations = 60', 'generations = 10'));
    await page.getByRole('button', { name: 'Solve' }).click();
    await page.waitForSelector('.space');
    const { front } = await answerOf(page);
    assert.equal(await page.locator('.space .front-dot').count(), front.length);
    // orthographic: differences of the pictures are those of the objectives, turned; all axes of the box appear
    const words = await page.locator('.space .axis-name').allTextContents();
    assert.deepEqual(words, ['pull_lost', 'torque', 'sinking']);
    const seen = () => page.locator('.space .front-dot').evaluateAll((dots) => dots.map((dot) => [Number(dot.getAttribute('cx')), Number(dot.getAttribute('cy'))]).sort((a, b) => a[0] - b[0]));
    const before = await seen();
    await page.locator('.space').focus();
    await page.keyboard.press('ArrowRight');
    const turned = await seen();
    assert.notDeepEqual(turned, before);
    await page.keyboard.press('ArrowLeft');
    (await seen()).forEach(([x, y], i) => assert.ok(Math.hypot(x - before[i][0], y - before[i][1]) < 1e-6));
    const box = await boxOf(page.locator('.space'));
    await page.mouse.move(box.x + 20, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + 120, box.y + 60);
    await page.mouse.up();
    assert.notDeepEqual(await seen(), before);
    await page.locator('.space .front-dot').first().click();
    assert.equal(await page.locator('.front-dot.is-chosen').count(), 4);
    assert.equal(await page.locator('.compromise.is-chosen').count(), 1);
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('limits on the axes pale the compromises outside in all pictures, by pointer and by keyboard', async () => {
  await withPage({ hash: '#optimise' }, async (page) => {
    await solve(page, 'pull-against-torque');
    const { front } = await answerOf(page);
    const axis = page.getByRole('slider', { name: 'Limits of radius_m' });
    const radii = front.map(({ x }) => x.radius_m);
    const [low, high] = [Math.min(...radii), Math.max(...radii)];
    await axis.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await boxOf(axis);
    // the lower half of the axis
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2, y + height - 1, { steps: 4 });
    await page.mouse.up();
    const half = radii.filter((radius) => radius <= (low + high) / 2).length;
    const left = async () => Number((await page.locator('.brushed output').textContent()).match(/^\d+/)[0]);
    assert.ok(half > 0 && half < front.length);
    assert.ok(Math.abs(await left() - half) <= 2, `${await left()} of ${half}`);
    for (const kind of ['.front-dot', '.compromise']) assert.equal(await page.locator(`${kind}:not(.is-out)`).count(), await left(), kind);
    // what is chosen stays limited
    await page.locator('.front-dot').nth(2).click();
    assert.equal(await page.locator('.compromise:not(.is-out)').count(), await left());
    assert.deepEqual(await seriousFindings(page), []);
    await axis.focus();
    await page.keyboard.press('Escape');
    assert.equal(await page.locator('.is-out').count(), 0);
    for (let i = 0; i < 10; i += 1) await page.keyboard.press('ArrowDown');
    assert.equal(await left(), half);
    assert.match(await axis.getAttribute('aria-valuetext'), / to /);
    await page.getByRole('button', { name: 'Drop the limits' }).click();
    assert.equal(await page.locator('.is-out').count(), 0);
  });
});

test('a search says how far it is, and a design drives in a scenario', async () => {
  await withPage({ hash: '#optimise' }, async (page) => {
    await page.evaluate(() => {
      window.said = [];
      new MutationObserver(() => window.said.push(document.querySelector('.problem .run-status').textContent)).observe(document.querySelector('.problem .run-status'), { childList: true });
    });
    await solve(page, 'pull-against-torque');
    const said = await page.evaluate(() => window.said);
    assert.ok(said.filter((text) => /^solving: generations, \d+ of 60$/.test(text)).length > 5, said.join('; '));
    assert.match(said.at(-1), /^solved in/);
    const { radius_m, width_m } = await page.evaluate(() => { const { front, knee } = window.grouser.views.get('optimise').answer; return front[knee].x; });
    await page.getByRole('button', { name: 'Drive the sandbox with it' }).click();
    await page.waitForFunction(() => /driven in/.test(document.querySelector('.run-status')?.textContent ?? ''));
    const { title, wheels } = await page.evaluate(() => {
      const { run } = window.grouser.views.get('run');
      return { title: run.title, wheels: run.wheels.map((wheel) => [wheel.name, wheel.radius_m, wheel.width_m]) };
    });
    assert.match(title, /^Wheels of 1\d\d × 200 mm on sandy-loam$/);
    const changed = wheels.filter(([, radius, width]) => Math.abs(radius - radius_m) < 1e-6 && Math.abs(width - width_m) < 1e-6);
    assert.deepEqual(changed.map(([name]) => name), ['front_left', 'front_right', 'rear_left', 'rear_right']);
    assert.equal(wheels.length, 6);
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('nothing is solved before there is a problem', async () => {
  await withPage({ hash: '#optimise' }, async (page) => {
    const solve = page.getByRole('button', { name: 'Solve' });
    await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
    assert.ok(await solve.isEnabled());
    await page.fill('.problem textarea', ' ');
    assert.ok(await solve.isDisabled());
    await page.fill('.problem textarea', 'format = 1');
    assert.ok(await solve.isEnabled());
  });
});

test('a search is stopped, and the next one runs', async () => {
  await withPage({ hash: '#optimise' }, async (page) => {
    await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
    const text = await page.locator('.problem textarea').inputValue();
    await page.fill('.problem textarea', text.replace('generations = 60', 'generations = 5000'));
    await page.getByRole('button', { name: 'Solve' }).click();
    await page.waitForFunction(() => /generations, \d+ of 5000/.test(document.querySelector('.problem .run-status')?.textContent));
    await page.getByRole('button', { name: 'Stop' }).click();
    await page.waitForFunction(() => document.querySelector('.problem .run-status')?.textContent === 'stopped');
    await page.fill('.problem textarea', text);
    await page.getByRole('button', { name: 'Solve' }).click();
    await page.waitForSelector('.optimise .hero');
  });
});

test('a problem that is none is refused with its place', async () => {
  await withPage({ hash: '#optimise', width: 390, height: 844 }, async (page) => {
    await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
    await page.fill('.problem textarea', 'format = 1\nmethod = "minmax"\n');
    await page.getByRole('button', { name: 'Solve' }).click();
    await page.waitForSelector('.problem .is-error');
    assert.match(await page.locator('.problem .run-status').textContent(), /problem\.toml|minimax|method/);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
  });
});
