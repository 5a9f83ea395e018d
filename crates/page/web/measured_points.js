// Measured points that are laid over the curves.

/** The points of a CSV with a column `slip` and at least one of the columns `keys`. */
export function measuredPoints(text, keys) {
  const rows = text.replace(/^\ufeff/, '').split(/\r?\n/).filter((line) => line.trim() !== '' && !line.startsWith('#'));
  if (rows.length < 2) throw new Error('a header and at least one row are needed');
  const header = rows[0].split(',').map((name) => name.trim());
  const column = (name) => {
    const at = header.indexOf(name);
    if (at < 0) return null;
    return rows.slice(1).map((row, i) => {
      const cell = (row.split(',')[at] ?? '').trim();
      if (cell === '') return null;
      const value = Number(cell);
      if (!Number.isFinite(value)) throw new Error(`row ${i + 2}, column ${name}: “${cell.slice(0, 20)}” is not a number`);
      return value;
    });
  };
  const out = { slip: column('slip') };
  if (!out.slip) throw new Error('no column `slip`');
  const known = keys.filter((key) => header.includes(key));
  if (!known.length) throw new Error(`none of the columns ${keys.join(', ')}`);
  for (const key of known) out[key] = column(key);
  return out;
}
