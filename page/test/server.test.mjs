// The page from the server, in a real browser.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { test } from 'node:test';
import { commandJson, seriousFindings, withPage } from './browser.mjs';

/** Starts the server and gives its address. */
async function served(use) {
  const server = spawn(process.env.GROUSER_VIEW ?? 'grouser-view', [], { stdio: ['ignore', 'pipe', 'inherit'] });
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
      for (const [mine, theirs] of same) {
        for (const [key, value] of Object.entries(mine)) {
          if (typeof value === 'number') assert.ok(Math.abs(value - theirs[key]) <= 1e-9 * Math.max(1, Math.abs(value)), `${key}: ${value} and ${theirs[key]}`);
        }
      }
      const theirs = commandJson('grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2');
      assert.ok(Math.abs(same[2][1].drawbar_pull_n - theirs.drawbar_pull_n) < 1e-9);
      assert.deepEqual(await seriousFindings(page), []);
      await page.click('a[data-view="run"]');
      await page.getByRole('button', { name: 'Drive the sandbox' }).click();
      await page.waitForSelector('.run-body:not([hidden])', { timeout: 240000 });
    });
  });
});
