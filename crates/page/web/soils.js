// Soils: the numbers that have sliders, and soil files.

/** The numbers of a soil that have sliders: key of the file, name, symbol, unit, slider range, power of ten shown. */
export const SOIL_FIELDS = [
  { key: 'k_phi_kn_per_m_n2', name: 'Frictional modulus', symbol: 'k_φ', unit: 'kN/mⁿ⁺²', low: 10, high: 10000, log: true },
  { key: 'k_c_kn_per_m_n1', name: 'Cohesive modulus', symbol: 'k_c', unit: 'kN/mⁿ⁺¹', low: -20, high: 100, step: 0.1 },
  { key: 'n', name: 'Sinkage exponent', symbol: 'n', unit: '', low: 0.1, high: 2, step: 0.01 },
  { key: 'cohesion_kpa', name: 'Cohesion', symbol: 'c', unit: 'kPa', low: 0, high: 20, step: 0.01 },
  { key: 'phi_deg', name: 'Friction angle', symbol: 'φ', unit: '°', low: 0, high: 50, step: 0.1 },
  { key: 'k_shear_m', name: 'Shear modulus', symbol: 'K', unit: 'mm', power: -3, low: 0.001, high: 0.1, log: true },
  { key: 'c_1', name: 'Place of peak stress', symbol: 'c_1', unit: '', low: 0, high: 1, step: 0.01 },
  { key: 'c_2', name: 'its growth with slip', symbol: 'c_2', unit: '', low: -0.5, high: 1, step: 0.01 },
  { key: 'n_1', name: 'Growth of n with slip', symbol: 'n_1', unit: '', low: 0, high: 1.5, step: 0.01 },
  { key: 'rebound', name: 'Rebound behind the wheel', symbol: 'λ', unit: '', low: 0, high: 1, step: 0.01 },
];

/** What a source need not give. */
export const OPEN_KEYS = ['k_shear_m', 'c_1', 'c_2'];

/** Numbers used where a source gives none and nothing else is set; the page says that they are not the source's. */
const STAND_IN = { k_shear_m: 0.02, c_1: 0.4, c_2: 0.2 };

/** The numbers of a catalogue entry, open ones out of `others`; `open` lists what the source does not give. */
export function numbersOf(entry, others = {}) {
  const numbers = {};
  const open = [];
  for (const { key } of SOIL_FIELDS) {
    const own = entry[key];
    if (own !== null && own !== undefined) numbers[key] = own;
    else if (OPEN_KEYS.includes(key)) {
      numbers[key] = others[key] ?? STAND_IN[key];
      open.push(key);
    } else numbers[key] = 0;
  }
  return { numbers, open };
}

/** A soil as the text of a soil file. `extra` has the lines of a file that have no slider. */
export function soilToml(numbers, { name = 'soil', source = '', extra = '', weight = null } = {}) {
  const quoted = (text) => JSON.stringify(String(text)).replace(/\u007f/g, '');
  const lines = ['format = 1', `name = ${quoted(name)}`];
  if (source) lines.push(`source = ${quoted(source)}`);
  for (const { key } of SOIL_FIELDS) {
    if ((key === 'n_1' || key === 'rebound') && numbers[key] === 0) continue;
    lines.push(`${key} = ${decimal(numbers[key])}`);
  }
  if (weight !== null) lines.push(`unit_weight_n_per_m3 = ${decimal(weight)}`);
  if (extra) lines.push(extra);
  return `${lines.join('\n')}\n`;
}

/** A number as TOML writes a float. */
export function decimal(value) {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}
