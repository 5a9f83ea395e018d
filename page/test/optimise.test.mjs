// The optimiser in a real browser, held to the command.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { ROOT, assertSame, commandJson, seriousFindings, withPage } from './browser.mjs';

const answerOf = (page) => page.evaluate(() => window.grouser.views.get('optimise').answer);

async function solve(page, name) {
  await page.waitForFunction(() => document.querySelector('.problem textarea').value.length > 50);
  await page.selectOption('select[aria-label="Example"]', name);
  await page.waitForFunction(() => document.querySelector('.problem textarea').value.length > 50);
  await page.waitForTimeout(100);
  await page.getByRole('button', { name: 'Solve' }).click();
  await page.waitForSelector('.optimise .hero', { timeout: 240000 });
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

test('a problem that is none is refused with its place', async () => {
  await withPage({ hash: '#optimise', width: 390, height: 844 }, async (page) => {
    await page.waitForFunction(() => document.querySelector('.problem textarea').value.length > 50);
    await page.fill('.problem textarea', 'format = 1\nmethod = "minmax"\n');
    await page.getByRole('button', { name: 'Solve' }).click();
    await page.waitForSelector('.problem .is-error');
    assert.match(await page.locator('.problem .run-status').textContent(), /problem\.toml|minimax|method/);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
  });
});
