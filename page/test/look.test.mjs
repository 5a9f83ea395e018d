// What a reader sees: on paper, on a phone, by keyboard, under the pointer.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { boxOf, seriousFindings, withPage } from './browser.mjs';

const VIEWS = ['explore', 'optimise', 'run'];
/** Drives the sandbox, then a scenario and its drivers by their names. */
async function driven(page, ...choices) {
  const ended = () => page.waitForFunction(() => /driven in/.test(document.querySelector('.run-status')?.textContent ?? ''), null, { timeout: 240000 });
  if (!choices.length) {
    await page.getByRole('button', { name: 'Drive the sandbox' }).click();
    await ended();
  }
  for (const choice of choices) {
    await page.evaluate(() => { document.querySelector('.run-status').textContent = ''; });
    await page.getByLabel('Another scenario').selectOption(choice);
    await ended();
  }
}

/** Names of axes and labels that cover each other, by their charts. */
const covered = (page) => page.evaluate(() => [...document.querySelectorAll('.chart')].flatMap((chart) => {
  const box = (element) => element.getBoundingClientRect();
  const names = [...chart.querySelectorAll('.axis-name')];
  const labels = [...chart.querySelectorAll('.axis-text text:not(.axis-name)')];
  const meets = (a, b) => a.left < b.right - 0.5 && b.left < a.right - 0.5 && a.top < b.bottom - 0.5 && b.top < a.bottom - 0.5;
  return names.flatMap((name) => labels.filter((label) => meets(box(name), box(label))).map((label) => `${chart.getAttribute('aria-label')}: ${name.textContent} over ${label.textContent}`));
}));

test('every view fits a phone and has labels that can be read, light and dark', async () => {
  for (const dark of [false, true]) {
    for (const hash of VIEWS) {
      await withPage({ hash: `#${hash}`, width: 390, height: 844, dark }, async (page) => {
        if (hash === 'run') {
          await driven(page);
          await page.getByRole('button', { name: 'One chart for each wheel' }).click();
          await page.waitForTimeout(300);
          // no cell of the wheels' table is cut off
          const cut = await page.evaluate(() => {
            const { right } = document.querySelector('.wheels').closest('.card').getBoundingClientRect();
            return [...document.querySelectorAll('.wheels td, .wheels th')].filter((cell) => {
              const range = document.createRange();
              range.selectNodeContents(cell);
              return range.getBoundingClientRect().right > right;
            }).map((cell) => cell.textContent);
          });
          assert.deepEqual(cut, []);
        }
        assert.deepEqual(await covered(page), [], hash);
        // no name in a picture is cut off
        const cut = await page.evaluate(() => [...document.querySelectorAll('.stress text, .hero svg text')].filter((text) => {
          const [own, picture] = [text, text.ownerSVGElement].map((element) => element.getBoundingClientRect());
          return own.width && (own.left < picture.left || own.right > picture.right);
        }).map((text) => text.textContent));
        assert.deepEqual(cut, [], hash);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390, hash);
        assert.deepEqual(await seriousFindings(page), []);
      });
    }
  }
});

test('a run on paper has its pictures and keys in colour, and nothing to operate', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await driven(page);
    await page.emulateMedia({ media: 'print' });
    for (const name of ['.top', '.player', '.run-tools']) assert.ok(!(await page.locator(name).isVisible()), name);
    for (const name of ['.map', '.slip-key', '.decisions']) assert.ok(await page.locator(name).first().isVisible(), name);
    assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('.slip-key'), '::before').printColorAdjust), 'exact');
    // A4 at 96 dpi without margins
    await page.setViewportSize({ width: 718, height: 1046 });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 718);
  });
});

test('the robot is on its way from the start, and values follow the pointer in all charts', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await driven(page);
    await page.waitForSelector('.map .robot[transform]', { state: 'attached' });
    const inside = await page.evaluate(() => {
      const robot = document.querySelector('.map .robot').getBoundingClientRect();
      const ground = document.querySelector('.ground-map').getBoundingClientRect();
      return robot.left >= ground.left - 8 && robot.right <= ground.right && robot.top >= ground.top && robot.bottom <= ground.bottom;
    });
    assert.ok(inside, 'the robot stands on the ground');
    const row = () => page.locator('.wheels tbody tr').first().textContent();
    const torques = () => page.locator('[aria-label="Torque of each motor"] .chart-values').textContent();
    assert.match(await row(), /–/);
    assert.match(await torques(), /front_left 0/);
    const plot = page.locator('[aria-label="Slip of each wheel"] .plot');
    const { x, y, width, height } = await boxOf(plot);
    await page.mouse.move(x + width / 4, y + height / 2);
    await page.waitForFunction(() => /0\.\d+ ± 0\.\d+.*Driving/.test(document.querySelector('.wheels tbody tr').textContent));
    assert.match(await torques(), /front_left \d\.\d+/);
    assert.ok(await page.locator('.hover-line').count() >= 3);
    assert.ok(Number(await page.locator('.player input').inputValue()) < 0.1, 'the cursor stays');
    await page.mouse.move(2, 2);
    await page.waitForFunction(() => !document.querySelector('.hover-line'));
    assert.match(await row(), /–/);
  });
});

test('states and decisions of the controller, their reasons, and other drivers are in words', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await driven(page, 'soft-patch open-loop', 'soft-patch controller');
    assert.match(await page.locator('.place').textContent(), /grey: the way of open-loop/);
    assert.match(await page.locator('.decisions li').first().textContent(), /: /);
    const states = page.locator('.states li');
    assert.ok(await states.count() > 0);
    const run = await page.evaluate(() => window.grouser.views.get('run').run.mode);
    assert.deepEqual(await states.evaluateAll((all) => all.map((one) => one.textContent.split(' ').at(-1))), run.map(([, name]) => name));
    // by keyboard: from a state to its time
    await states.last().getByRole('button').focus();
    await page.keyboard.press('Enter');
    const [time, name] = run.at(-1);
    assert.ok(Math.abs(Number(await page.locator('.player input').inputValue()) - time) < 1e-6);
    assert.equal(await page.locator('.badge').textContent(), name);
    // play and pause, and a step of the time
    await page.getByRole('button', { name: 'Play' }).focus();
    await page.keyboard.press('Space');
    await page.getByRole('button', { name: 'Pause' }).waitFor();
    await page.keyboard.press('Space');
    await page.getByRole('button', { name: 'Play' }).waitFor();
    // what is focused can be seen
    const outlined = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
    assert.notEqual(outlined, 'none');
    assert.deepEqual(await seriousFindings(page), []);
  });
});

test('every control of every view is reached by the keyboard and has a name', async () => {
  for (const hash of VIEWS) {
    await withPage({ hash: `#${hash}` }, async (page) => {
      if (hash === 'run') await driven(page);
      const wanted = await page.evaluate(() => [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex="0"]')]
        .filter((one) => one.checkVisibility({ checkVisibilityCSS: true }) && !one.disabled && one.tabIndex >= 0).length);
      const seen = await page.evaluate(() => { window.seen = new Set(); return 0; });
      assert.equal(seen, 0);
      let reached = 0;
      for (let i = 0; i < 3 * wanted && reached < wanted; i += 1) {
        await page.keyboard.press('Tab');
        reached = await page.evaluate(() => {
          if (document.activeElement !== document.body) window.seen.add(document.activeElement);
          return window.seen.size;
        });
      }
      // a group of choices is one stop
      const groups = await page.evaluate(() => [...document.querySelectorAll('[role="radiogroup"], fieldset, [role="tablist"]')].length);
      assert.ok(reached >= wanted - 3 * groups - 1, `${hash}: ${reached} of ${wanted}`);
    });
  }
});
