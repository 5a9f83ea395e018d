// The page from a web server of files, as it is hosted statically: its own files and the modules beside them.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join } from 'node:path';
import { test } from 'node:test';
import { ROOT, assertSame, commandJson, withPage } from './browser.mjs';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.gz': 'application/gzip' };

/** Serves the files below /grouser/, and nothing else. */
async function hosted(use) {
  const server = createServer(({ url }, response) => {
    const name = url.replace(/^\/grouser\//, '') || 'index.html';
    const folder = name.endsWith('.wasm.gz') ? 'page/dist' : 'crates/page/web';
    try {
      const bytes = readFileSync(join(ROOT, folder, name));
      response.writeHead(200, { 'content-type': TYPES[extname(name)] }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  try {
    await use(`http://127.0.0.1:${server.address().port}/grouser/`);
  } finally {
    server.close();
  }
}

test('a folder of a web server is the page: explorer, optimiser, drive and figure', async () => {
  await hosted(async (address) => {
    const allow = (to) => to.startsWith(address);
    await withPage({ address, allow, hash: '#explore?soil=dry-sand&radius_m=0.125&width_m=0.1&load_n=80&slip=0.2' }, async (page) => {
      const { drawbar_pull_n: pull } = await page.evaluate(() => window.grouser.views.get('explore').point);
      assertSame(pull, commandJson('grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2').drawbar_pull_n, 'pull');
      const saved = page.waitForEvent('download');
      await page.getByRole('button', { name: 'Save as figure' }).click();
      assert.equal((await saved).suggestedFilename(), 'wheel-on-soil.svg');
      await page.click('a[data-view="optimise"]');
      await page.waitForFunction(() => document.querySelector('.problem textarea')?.value.length > 50);
      await page.getByRole('button', { name: 'Solve' }).click();
      await page.waitForSelector('.front-dot');
      await page.click('a[data-view="run"]');
      await page.getByRole('button', { name: 'Drive the sandbox' }).click();
      await page.waitForSelector('.run-body:not([hidden])');
    });
  });
});
