// Files that are dropped on the page: what each is, by what it holds.

import { shown } from './format.js';
import { BadFile, isEstimates } from './run_data.js';

/** Largest file that the page reads, bytes. */
const MAX_FILE_BYTES = 512 * 1024 * 1024;

/** The files `{robot, columns, scenario, log, table, report}` with one more. */
export async function withFile(files, file) {
  const { name, size } = file;
  if (size > MAX_FILE_BYTES) throw new BadFile(`${name} has ${shown(size / 1048576)} MiB, but the page reads at most ${MAX_FILE_BYTES / 1048576} MiB: use grouser view ${name} --robot …`);
  if (/\.toml$/i.test(name)) {
    const text = await file.text();
    const isRobot = /^\s*\[\[wheel/m.test(text) && !/^\s*\[\[column/m.test(text) && /radius/m.test(text);
    const kind = /^\s*\[\[leg\]\]/m.test(text) ? 'scenario' : isRobot ? 'robot' : 'columns';
    return { ...files, [kind]: { name, text } };
  }
  if (/\.json$/i.test(name)) return { report: { name, text: await file.text() } };
  const head = await file.slice(0, 4096).text();
  if (isEstimates(head)) return { table: { name, text: await file.text() } };
  const { table: _, ...others } = files;
  return { ...others, log: { name, file } };
}
