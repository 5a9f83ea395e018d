// The state as text for elsewhere: a command, a soil file, Rust, Python.

import { h } from './dom.js';
import { hasLugs } from './requests.js';
import { SOIL_FIELDS, decimal, numbersOf, soilToml } from './soils.js';
import { weight } from './state.js';

/** What the command's flags can complete or override of a soil of the catalogue. */
const OVERRIDES = { k_shear_m: '--k-shear-m', c_1: '--c-1', c_2: '--c-2' };

/** The command line that gives the numbers of the page. */
export function asCommand(state, catalogue) {
  const { flags, file } = soilFlags(state, catalogue);
  const parts = ['grouser wheel', ...flags, `--radius-m ${state.radius_m}`, `--width-m ${state.width_m}`];
  if (hasLugs(state)) {
    parts.push(`--grouser-height-m ${state.grouser_height_m}`, `--grouser-count ${state.grouser_count}`, `--grouser-thickness-m ${state.grouser_thickness_m}`);
  }
  if (state.rebound !== 0 && !file) parts.push(`--rebound ${state.rebound}`);
  if (state.load_by === 'mass') parts.push(`--mass-kg ${state.mass_kg}`, `--gravity-m-per-s2 ${state.gravity_m_per_s2}`);
  else parts.push(`--load-n ${state.load_n}`);
  parts.push(`--slip ${state.slip}`);
  if (state.slope_deg !== 0) parts.push(`--slope-deg ${state.slope_deg}`);
  if (state.slip_angle_deg !== 0) parts.push(`--slip-angle-deg ${state.slip_angle_deg}`);
  const command = parts.join(' \\\n  ');
  return file ? `cat > soil.toml <<'END'\n${file}END\n${command}\n` : `${command}\n`;
}

/** `--soil` with its overrides, or the file that is needed. */
function soilFlags(state, catalogue) {
  const entry = catalogue.get(state.soil);
  const own = entry ? numbersOf(entry).numbers : {};
  const open = entry ? numbersOf(entry).open : [];
  const changed = SOIL_FIELDS.map(({ key }) => key).filter((key) => key !== 'rebound' && (state[key] !== own[key] || open.includes(key)));
  if (!entry || state.extra || changed.some((key) => !OVERRIDES[key])) {
    return { flags: ['--soil ./soil.toml'], file: asToml(state, catalogue) };
  }
  return { flags: [`--soil ${state.soil}`, ...changed.map((key) => `${OVERRIDES[key]} ${state[key]}`)], file: null };
}

/** The soil as a file. */
export function asToml(state, catalogue) {
  const entry = catalogue.get(state.soil);
  const own = entry ? numbersOf(entry, state).numbers : {};
  const changed = entry && SOIL_FIELDS.some(({ key }) => state[key] !== own[key]);
  const source = entry ? `${changed ? 'changed from: ' : ''}${entry.source}` : '';
  return soilToml(state, { name: state.soil_name, source, extra: state.extra });
}

/** A Rust program that prints pull and sinkage. */
export function asRust(state) {
  const others = ['n_1', 'rebound'].filter((name) => state[name] !== 0).map((name) => `${name}: ${decimal(state[name])}, `);
  const soil = `let soil = Soil::bekker(1e3 * ${decimal(state.k_c_kn_per_m_n1)}, 1e3 * ${decimal(state.k_phi_kn_per_m_n2)}, ${decimal(state.n)})
    .cohesion(1e3 * ${decimal(state.cohesion_kpa)})
    .phi(Angle::from_deg(${decimal(state.phi_deg)}))
    .k_shear(${decimal(state.k_shear_m)})
    .stress_position(${decimal(state.c_1)}, ${decimal(state.c_2)})
    ${others.length ? `.params()?;\nlet soil = Soil::new(SoilParams { ${others.join('')}..soil })?;` : '.soil()?;'}`;
  const lugs = hasLugs(state)
    ? `.with_grousers(Grousers {\n    height: ${decimal(state.grouser_height_m)},\n    rule: GrouserRule::Lugs { count: ${decimal(state.grouser_count)}, thickness: ${decimal(state.grouser_thickness_m)} },\n})?` : '';
  const load = state.slope_deg === 0 ? decimal(weight(state)) : `${decimal(weight(state))} * Angle::from_deg(${decimal(state.slope_deg)}).cos()`;
  const slip = `Slip::new(${decimal(state.slip)})?`;
  const motion = state.slip_angle_deg === 0 ? `Kinematics::straight(${slip})` : `Kinematics::with_slip_angle(${slip}, Angle::from_deg(${decimal(state.slip_angle_deg)}))?`;
  const names = ['Angle', ...(hasLugs(state) ? ['GrouserRule', 'Grousers'] : []), 'Kinematics', 'RigidWheel', 'Settings', 'Slip', 'Soil', ...(others.length ? ['SoilParams'] : []), 'WheelOnSoil'];
  return `use grouser_terra::{${names.join(', ')}};

fn main() -> grouser_terra::Result<()> {
${indented(`${soil}
let wheel = RigidWheel::new(${decimal(state.radius_m)}, ${decimal(state.width_m)})?${lugs};
let contact = WheelOnSoil::new(wheel, soil, Settings::default())?;
let motion = ${motion};
match contact.under_load(${load}, &motion)?.point() {
    Some(point) => println!("pull {} N, sinkage {} m", point.forces.drawbar_pull, point.sinkage),
    None => println!("no sinkage carries the load"),
}
Ok(())`)}
}
`;
}

function indented(text) {
  return text.split('\n').map((line) => (line ? `    ${line}` : line)).join('\n');
}

/** A Python program that prints the operating point. */
export function asPython(state, catalogue) {
  const load = state.slope_deg === 0 ? `${weight(state)}` : `${weight(state)} * math.cos(math.radians(${state.slope_deg}))`;
  const toml = asToml(state, catalogue).replaceAll('\\', '\\\\').replaceAll('"""', '\\"\\"\\"');
  const sizes = [`radius_m=${state.radius_m}`, `width_m=${state.width_m}`];
  if (hasLugs(state)) {
    sizes.push(`grouser_height_m=${state.grouser_height_m}`, `grouser_count=${state.grouser_count}`, `grouser_thickness_m=${state.grouser_thickness_m}`);
  }
  return `${state.slope_deg === 0 ? '' : 'import math\n\n'}from grouser import soils, wheel

soil = soils.Soil.from_toml("""\\
${toml}""")
contact = wheel.WheelOnSoil(wheel.Wheel(${sizes.join(', ')}), soil)
point = contact.under_load(load_n=${load}, slip=${state.slip}, slip_angle_deg=${state.slip_angle_deg})
print(f"pull {point.drawbar_pull_n} N, sinkage {point.sinkage_m} m" if point else "no sinkage carries the load")
`;
}

const FORMS = [
  ['Command line', asCommand],
  ['Soil file (TOML)', asToml],
  ['Rust', asRust],
  ['Python', asPython],
];

/** The menu "Copy as". */
export function copyMenu(stateOf, catalogue) {
  const dialog = h('dialog', { class: 'copy', 'aria-label': 'Copy as' });
  const text = h('pre', { tabindex: 0 });
  const done = h('span', { role: 'status', class: 'muted' });
  const tabs = FORMS.map(([name, form]) => h('button', {
    type: 'button', class: 'quiet', on: { click: (event) => show(event.currentTarget, form) },
  }, name));
  const show = (tab, form) => {
    for (const other of tabs) other.setAttribute('aria-pressed', String(other === tab));
    text.textContent = form(stateOf(), catalogue);
    done.textContent = '';
  };
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(text.textContent);
      done.textContent = 'copied';
    } catch {
      // without the permission the text is selected, for the keyboard
      getSelection().selectAllChildren(text);
      done.textContent = 'selected: copy with Ctrl C';
    }
  };
  dialog.append(
    h('header', {}, h('h2', {}, 'Copy as'), h('button', { type: 'button', class: 'quiet', 'aria-label': 'Close', on: { click: () => dialog.close() } }, '×')),
    h('div', { class: 'segments' }, tabs), text,
    h('footer', {}, done, h('button', { type: 'button', class: 'primary', on: { click: copy } }, 'Copy')),
  );
  const open = () => {
    show(tabs[0], FORMS[0][1]);
    dialog.showModal();
  };
  return h('div', {}, h('button', { type: 'button', class: 'quiet', on: { click: open } }, 'Copy as…'), dialog);
}
