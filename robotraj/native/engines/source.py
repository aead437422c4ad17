"""C source of a point function in parts, which a compiler translates in linear time and on several cores.

CasADi writes an SX function as one C function of tens of thousands of lines; compile time grows faster than that.
This file rewrites the same lines in the same order:

- Every value is assigned once (``t17``). A new function begins every few hundred lines; several files hold them.
- Values used in only one part are its local variables. Values that later parts read are kept in a work array.
  Constants and arguments are read again where they are used.
- Every value is a vector over points, as wide as a vector register; one call evaluates several points.

The order of operations is CasADi's: results equal those of its virtual machine bit for bit.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import casadi as ca

from robotraj._util.errors import RobotrajError
from robotraj._util.values import dataclass

_ASSIGNED = re.compile(r"  a(\d+)=(.*);")
_ARGUMENT = re.compile(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0")
_RESULT = re.compile(r"  if \(res\[(\d+)\]!=0\) res\[\1\]\[(\d+)\]=(.*);")
_REGISTER = re.compile(r"\ba(\d+)\b")
_NUMBER = r"-?\d+\.?\d*(?:e[-+]?\d+)?"
_WHOLE = re.compile(rf"\(?-?(?:t\d+|{_NUMBER})(?:[-+*/](?:t\d+|{_NUMBER}))?\)?")
_SQUARE = re.compile(r"casadi_sq\(\s*(t\d+)\s*\)")
_VALUE = re.compile(r"\bt(\d+)\b")
_TYPES = """
#include <stdint.h>
#define POINTS {points}
typedef double V __attribute__((vector_size({bytes})));
"""
# Without this instruction, later SSE code (BLAS, the solver) is slower; gcc adds it only from -O2 on.
_LEAVE = """#ifdef __AVX__
  __builtin_ia32_vzeroupper();
#endif
"""
_PER_FILE = 6000
"""Lines of a file; the start of the compiler is then a small part of its time."""


@dataclass(frozen=True)
class Source:
    """C files of one library and the name of the function it exports.

    Attributes
    ----------
    name : str
        Takes ``points`` columns of every argument at once.
    files : tuple of str
        Texts, to be compiled separately and linked.
    """

    name: str
    files: tuple[str, ...]


@dataclass
class _Line:
    """One line: a value assigned (``target``) or written out, and the values it reads."""

    text: str
    reads: list[int]
    target: int | None = None
    cheap: bool = False


def write_source(function: ca.Function, points: int, lines_per_part: int = 400) -> Source:
    """Write an SX function of n arguments as C that evaluates several points at once.

    Parameters
    ----------
    function : casadi.Function
        Of dense columns, one output; an ``SXFunction``.
    points : int
        L: argument i of the C function is (n_i, L), its result (n_y, L), columns of CasADi's order.
    lines_per_part : int
        Lines after which a new C function begins.
    """
    name = function.name()
    generator = ca.CodeGenerator("part.c", {"with_header": False})
    generator.add(function)
    text = generator.dump()
    start = text.index("static int casadi_f0(")
    opened = text.index("{\n", start) + 2
    body = text[opened : text.index("\n  return 0;\n}", opened)].split("\n")
    head = _head(text[: text.rindex("/*", 0, start)], points) + _parameters(function)
    lines = _single_assignment(body)
    parts = [lines[i : i + lines_per_part] for i in range(0, len(lines), lines_per_part)]
    definitions, slots = _write_parts(parts, name)
    per_file = max(1, _PER_FILE // lines_per_part)
    files = ["".join(definitions[i : i + per_file]) for i in range(0, len(definitions), per_file)]
    return Source(name, (head + _entry(function, points, len(parts), slots), *(head + file for file in files)))


def _head(preamble: str, points: int) -> str:
    """Return CasADi's includes and helper functions without its exports, and the type of a value."""
    preamble = re.sub(r"/\* Configuration this file.*?\n\n", "", preamble, flags=re.S)
    preamble = re.sub(r"static const casadi_int casadi_s\d+\[.*?;\n", "", preamble)
    # Every file of a library has its own copy of the helpers.
    preamble = re.sub(r"^casadi_real casadi_", "static casadi_real casadi_", preamble, flags=re.M)
    return f"{preamble}{_TYPES.format(bytes=8 * points, points=points)}"


def _single_assignment(body: Sequence[str]) -> list[_Line]:
    """Rename registers, which CasADi reuses, to values that are assigned once."""
    current: dict[str, int] = {}
    lines = []
    for line in body:
        if line.startswith("  casadi_real "):
            continue
        written = _RESULT.fullmatch(line)
        assigned = None if written else _ASSIGNED.fullmatch(line)
        if written is None and assigned is None:
            raise RobotrajError(
                f"CasADi {ca.__version__} wrote C code that robotraj cannot split: {line.strip()!r}. "
                "Use engine=rt.engines.Native()."
            )
        expression = written[3] if written else assigned[2]  # type: ignore[index]
        argument = _ARGUMENT.fullmatch(expression)
        if argument:
            expression = f"x{argument[1]}[{argument[2]}]"
        reads = [current[register] for register in _REGISTER.findall(expression)]
        expression = _REGISTER.sub(lambda match: f"t{current[match[1]]}", expression)
        if written:
            lines.append(_Line(f"  y{written[1]}[{written[2]}] = {_vector(expression)};", reads))
            continue
        target = len(lines)
        current[assigned[1]] = target  # type: ignore[index]
        simple = argument or not reads
        text = expression if argument else _vector(expression)
        if text is None:
            lanes = _VALUE.sub(r"t\1[i]", expression)
            text = f"V t{target}; for (int i = 0; i < POINTS; ++i) t{target}[i] = {lanes};"
        else:
            text = f"const V t{target} = {text};"
        lines.append(_Line(f"  {text}", reads, target, bool(simple)))
    return lines


def _vector(expression: str) -> str | None:
    """Rewrite arithmetic for vectors; None where it calls a function of one number."""
    square = _SQUARE.fullmatch(expression)
    if square:
        return f"{square[1]}*{square[1]}"
    if not _WHOLE.fullmatch(expression):
        return None
    # A scalar minus a zero vector is a vector; adding a zero vector would change the sign of -0.
    return expression if _VALUE.search(expression) else f"({expression}) - (V){{0}}"


def _write_parts(parts: Sequence[Sequence[_Line]], name: str) -> tuple[list[str], int]:
    """Return the parts as C functions, and the size of the work array that their values share."""
    home = {line.target: (p, line) for p, part in enumerate(parts) for line in part if line.target is not None}
    last = {read: p for p, part in enumerate(parts) for line in part for read in line.reads}
    slot: dict[int, int] = {}
    free: list[int] = []
    ending: dict[int, list[int]] = {}
    slots = 0
    definitions = []
    for p, part in enumerate(parts):
        before = sorted({read for line in part for read in line.reads if home[read][0] < p})
        loads = [home[v][1].text if home[v][1].cheap else f"  const V t{v} = w[{slot[v]}];" for v in before]
        stores = []
        # The part has loaded what it needs by the time it stores.
        free += ending.pop(p, [])
        for line in part:
            v = line.target
            if v is None or line.cheap or last.get(v, p) == p:
                continue
            if not free:
                free.append(slots)
                slots += 1
            slot[v] = free.pop()
            ending.setdefault(last[v], []).append(slot[v])
            stores.append(f"  w[{slot[v]}] = t{v};")
        text = "\n".join([*loads, *(line.text for line in part), *stores])
        definitions.append(f"void {name}_{p}(PARAMETERS) {{\n{text}\n}}\n")
    return definitions, slots


def _parameters(function: ca.Function) -> str:
    """Return the parameters of every part: arguments, results and work, one vector of points per number."""
    names = [f"const V* restrict x{i}" for i in range(function.n_in())]
    names += [f"V* restrict y{i}" for i in range(function.n_out())]
    return f"#define PARAMETERS {', '.join([*names, 'V* restrict w'])}\n"


def _entry(function: ca.Function, points: int, parts: int, slots: int) -> str:
    """Write the exported function and the entries that ``casadi.external`` requires."""
    name = function.name()
    ins = [("x", "in", i, function.numel_in(i)) for i in range(function.n_in())]
    outs = [("y", "out", i, function.numel_out(i)) for i in range(function.n_out())]
    prototypes = "".join(f"void {name}_{p}(PARAMETERS);\n" for p in range(parts))
    placed, at = "", slots
    for letter, _, i, size in [*ins, *outs]:
        placed += f"  V* {letter}{i} = w + {at};\n"
        at += size
    read = "".join(
        f"  for (int j = 0; j < {size}; ++j) for (int i = 0; i < POINTS; ++i)"
        f" x{k}[j][i] = arg[{k}] ? arg[{k}][i * {size} + j] : 0;\n"
        for _, _, k, size in ins
    )
    written = "".join(
        f"  if (res[{k}]) for (int j = 0; j < {size}; ++j) for (int i = 0; i < POINTS; ++i)"
        f" res[{k}][i * {size} + j] = y{k}[j][i];\n"
        for _, _, k, size in outs
    )
    names = ", ".join([*(f"x{i}" for _, _, i, _ in ins), *(f"y{i}" for _, _, i, _ in outs), "w"])
    calls = "".join(f"  {name}_{p}({names});\n" for p in range(parts))
    shapes = "".join(
        f"static const casadi_int {direction}{i}[3] = {{{size}, {points}, 1}};\n"
        for _, direction, i, size in [*ins, *outs]
    )
    asked = "".join(
        f"EXPORT casadi_int {name}_n_{direction}(void) {{ return {len(group)}; }}\n"
        f"EXPORT const casadi_int* {name}_sparsity_{direction}(casadi_int i) {{\n"
        f"  static const casadi_int* const all[] = {{{', '.join(f'{direction}{i}' for i in range(len(group)))}}};\n"
        f"  return all[i];\n}}\n"
        for direction, group in (("in", ins), ("out", outs))
    )
    return f"""{prototypes}
#define EXPORT __attribute__((visibility("default")))
EXPORT int {name}(const double** arg, double** res, casadi_int* iw, double* work, int mem) {{
  V* w = (V*)(((uintptr_t)work + sizeof(V) - 1) / sizeof(V) * sizeof(V));
{placed}{read}{calls}{written}{_LEAVE}  return 0;
}}
{shapes}{asked}EXPORT int {name}_work(casadi_int* arg, casadi_int* res, casadi_int* iw, casadi_int* w) {{
  if (arg) *arg = {len(ins)};
  if (res) *res = {len(outs)};
  if (iw) *iw = 0;
  if (w) *w = {points * (at + 1)};
  return 0;
}}
"""
