// Numbers for people.

/** `value` with `digits` significant digits, a true minus sign, no trailing exponent below a million. */
export function shown(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const size = Math.floor(Math.log10(Math.abs(value)));
  let text;
  if (size >= 6 || size < -4) {
    text = value.toExponential(digits - 1).replace('e+', 'e');
  } else {
    text = value.toFixed(Math.max(0, digits - 1 - size));
    if (/^-?0(\.0*)?$/.test(text)) text = '0';
  }
  return text.replace('-', '−');
}

/** `value` times ten to `power` in decimals, so that 12.7 mm are 0.0127 m and not 0.012699999999999999. */
export function shifted(value, power) {
  const [digits, exponent = '0'] = String(value).split('e');
  return Number(`${digits}e${Number(exponent) + power}`);
}

/** `value` rounded to `digits` significant digits. */
export function significant(value, digits) {
  return value === 0 ? 0 : Number(value.toPrecision(digits));
}

/** A duration in seconds as m:ss or h:mm:ss. */
export function clock(seconds, decimals = 0) {
  if (!Number.isFinite(seconds)) return '–';
  const sign = seconds < 0 ? '−' : '';
  const whole = Number(Math.abs(seconds).toFixed(decimals));
  const h = Math.floor(whole / 3600);
  const m = Math.floor((whole % 3600) / 60);
  const s = (whole % 60).toFixed(decimals).padStart(decimals ? 3 + decimals : 2, '0');
  return h ? `${sign}${h}:${String(m).padStart(2, '0')}:${s}` : `${sign}${m}:${s}`;
}
