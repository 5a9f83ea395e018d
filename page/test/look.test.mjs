// What a reader sees: on paper, on a phone, by keyboard, under the pointer.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { boxOf, resized, seriousFindings, settled, withPage } from './browser.mjs';

const VIEWS = ['explore', 'optimise', 'run'];
/** Drives the sandbox, then a scenario and its drivers by their names. */
async function driven(page, ...choices) {
  const ended = () => page.waitForFunction(() => /driven in/.test(document.querySelector('.run-status')?.textContent ?? ''));
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
          await settled(page);
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

test('numbers of charts have the face of the page, whose digits have the width that places them', async () => {
  await withPage({ hash: '#explore' }, async (page) => {
    const [label, width] = await page.evaluate(async () => {
      await document.fonts.ready;
      const text = document.querySelector('.chart .axis-text text:not(.axis-name)');
      const copy = text.cloneNode();
      copy.textContent = '0'.repeat(100);
      text.parentNode.append(copy);
      const wide = copy.getComputedTextLength() / 100;
      copy.remove();
      return [getComputedStyle(text).fontFamily, wide];
    });
    assert.match(label, /^"?Grouser Figures/);
    assert.ok(Math.abs(width - 6.7) < 0.1, `${width} px`);
  });
});

test('a wide screen is filled: the wheel beside its curves, pictures beside the answer', async () => {
  for (const hash of VIEWS) {
    await withPage({ hash: `#${hash}`, width: 1920, height: 1080 }, async (page) => {
      if (hash === 'run') await driven(page, 'soft-patch controller');
      if (hash === 'optimise') {
        await page.getByRole('button', { name: 'Solve' }).click();
        await page.waitForSelector('.front-dot');
      }
      await settled(page);
      const cards = await page.evaluate(() => [...document.querySelectorAll('main .card')].filter((one) => one.checkVisibility())
        .map((one) => one.getBoundingClientRect()).map(({ left, right, bottom }) => ({ left, right, bottom })));
      assert.ok(Math.min(...cards.map(({ left }) => left)) < 40 && Math.max(...cards.map(({ right }) => right)) > 1860, `${hash}: margins`);
      // curves and front are on one screen with the wheel and the answer
      if (hash !== 'run') for (const { bottom } of cards.slice(-2)) assert.ok(bottom <= 1080, `${hash}: ${bottom}`);
      assert.deepEqual(await covered(page), [], hash);
    });
  }
});

test('curves and classes of slip differ for readers who see colours otherwise, and text in their colours can be read', async () => {
  // Machado, Oliveira and Fernandes (2009): no protan, deutan or tritan cones
  const SIGHTS = [
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
  ];
  const linear = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  const seen = (sight, rgb) => sight.map((row) => Math.min(1, Math.max(0, row.reduce((sum, share, i) => sum + share * rgb[i], 0))));
  // Oklab (Ottosson 2020)
  const lab = ([r, g, b]) => {
    const [l, m, s] = [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566], [0.0883024619, 0.2817188376, 0.6299787005]].map(([x, y, z]) => Math.cbrt(x * r + y * g + z * b));
    return [[0.2104542553, 0.793617785, -0.0040720468], [1.9779984951, -2.428592205, 0.4505937099], [0.0259040371, 0.7827717662, -0.808675766]].map(([x, y, z]) => x * l + y * m + z * s);
  };
  const luminance = (hex) => linear(hex).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  for (const dark of [false, true]) {
    await withPage({ dark }, async (page) => {
      const colours = (kind, numbers) => page.evaluate(([name, all]) => all.map((i) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}${i}`).trim()), [kind, numbers]);
      const curves = await colours('curve-', [1, 2, 3, 4, 5, 6]);
      const classes = await colours('slip-', [0, 1, 2, 3, 4, 5]);
      const [card] = await colours('card', ['']);
      for (const sight of SIGHTS) {
        const labs = curves.map((hex) => lab(seen(sight, linear(hex))));
        for (let i = 0; i < 6; i += 1) for (let k = 0; k < i; k += 1) {
          const far = Math.hypot(...labs[i].map((value, axis) => value - labs[k][axis]));
          assert.ok(far > 0.09, `curves ${k + 1} and ${i + 1}, dark ${dark}, sight ${SIGHTS.indexOf(sight)}: ${far.toFixed(3)}`);
        }
        // more slip, further from the ground's lightness
        const lightness = classes.map((hex) => lab(seen(sight, linear(hex)))[0]);
        for (let i = 1; i < 6; i += 1) assert.ok((dark ? 1 : -1) * (lightness[i] - lightness[i - 1]) > 0.035, `class ${i} of ${lightness}`);
      }
      for (const hex of curves) {
        const [low, high] = [luminance(hex), luminance(card)].sort((a, b) => a - b);
        assert.ok((high + 0.05) / (low + 0.05) >= 4.5, `${hex} on ${card}`);
      }
    });
  }
});

test('a run on paper has its pictures and keys in colour, and nothing to operate', async () => {
  await withPage({ hash: '#run' }, async (page) => {
    await driven(page);
    await page.emulateMedia({ media: 'print' });
    for (const name of ['.top', '.player', '.run-tools', '.figure-file']) for (const one of await page.locator(name).all()) assert.ok(!(await one.isVisible()), name);
    for (const name of ['.map', '.slip-key', '.decisions']) assert.ok(await page.locator(name).first().isVisible(), name);
    assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('.slip-key'), '::before').printColorAdjust), 'exact');
    // A4 at 96 dpi without margins
    await resized(page, 718, 1046);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 718);
  });
});

test('a page that is ready has drawn its view', async () => {
  await withPage({ hash: '#explore' }, async (page) => {
    await page.addInitScript(() => {
      new MutationObserver(() => {
        if (document.body?.dataset.ready) window.drawn ??= [...document.querySelectorAll('.plot')].filter((plot) => plot.checkVisibility()).map((plot) => plot.hasAttribute('viewBox'));
      }).observe(document, { subtree: true, attributes: true });
    });
    await page.reload();
    await page.waitForFunction(() => window.drawn);
    const drawn = await page.evaluate(() => window.drawn);
    assert.ok(drawn.length > 1 && drawn.every(Boolean), `${drawn}`);
  });
});

test('explorer and front on paper: pictures fill their width, and the problem is whole', async () => {
  for (const hash of ['explore', 'optimise']) {
    await withPage({ hash: `#${hash}` }, async (page) => {
      if (hash === 'optimise') {
        await page.getByRole('button', { name: 'Solve' }).click();
        await page.waitForSelector('.front-dot');
      }
      await page.emulateMedia({ media: 'print' });
      await resized(page, 718, 1046);
      const plots = await page.locator('.plot').evaluateAll((all) => all.filter((plot) => plot.checkVisibility()).map((plot) => {
        const [, , width, height] = plot.getAttribute('viewBox').split(' ').map(Number);
        const box = plot.getBoundingClientRect();
        return Math.abs(box.height / box.width - height / width);
      }));
      assert.ok(plots.length > 1 && plots.every((off) => off < 0.02), `${plots}`);
      assert.equal(await page.locator('.plot-strip').evaluateAll((all) => all.filter((one) => one.checkVisibility()).length), 0);
      if (hash === 'optimise') assert.ok(await page.locator('.problem textarea').evaluate((text) => text.scrollHeight <= text.clientHeight + 2));
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 718);
    });
  }
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
    await page.waitForFunction(() => /0\.\d+ ± 0\.\d+.*Driving/.test(document.querySelector('.wheels tbody tr')?.textContent));
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
    assert.match(await page.locator('.place').textContent(), /grey: the path of open-loop/);
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
    // a number beside another is a number of its own
    const wide = await page.evaluate(() => [...document.querySelectorAll('.wheels tbody tr')].flatMap((row) => [...row.cells]).filter((cell) => cell.scrollWidth > cell.clientWidth + 1).map((cell) => cell.textContent));
    assert.deepEqual(wide, []);
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
