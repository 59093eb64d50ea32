"""The compiler of kernels: numba, which makes LLVM code of an entry.

    python -m rps_exudyn.base.kernel_compiler    write the code of all entries, as the package ships it

It is imported by developers, for laws that users add, and where the code that the package ships does not fit
its sources or the machine. The code is that for any processor of the machine's kind; `kernel_code` turns it
into that of the processor.
"""

import os
import re
import sys
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from typing import Any

if __name__ == "__main__":
    os.environ["NUMBA_CPU_NAME"] = "generic"  # which numba reads when it is imported

import numba
import numpy as np
from llvmlite import binding, ir
from numba import carray, types
from numba.core import cgutils
from numba.core.registry import cpu_target
from numba.extending import intrinsic, typeof_impl

from rps_exudyn.base import compiled
from rps_exudyn.base.compiled import Array, Entry, Function, Primitive


@cache
def dispatcher(function: Function) -> Any:
    """Return a function as numba has it."""
    absorbed = function.is_absorbed
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": absorbed}
    return numba.njit(function.py_func, error_model="numpy", **options)


@typeof_impl.register(Function)
def _type_of(function: Function, context: Any) -> Any:
    """The type of a function among the names of a kernel."""
    made = PRIMITIVES[function] if isinstance(function, Primitive) else dispatcher(function)
    return cpu_target.typing_context.resolve_value_type(made)


def from_python(function: Any) -> Any:
    """Return a function, of kernels or any other one, compiled for the arguments that come from Python."""
    function = function.py_func if isinstance(function, Function) else function
    return numba.njit(function, error_model="numpy")


# --- primitives


def _array(context: Any, builder: Any, kind: Any, data: Any, shape: Sequence[Any]) -> Any:
    """An array without gaps at an address."""
    made = context.make_array(kind)(context, builder)
    size = step = context.get_constant(types.intp, 8)
    strides: list[Any] = []
    for length in reversed(shape):
        strides.insert(0, step)
        step = builder.mul(step, length)
    made.data, made.itemsize, made.nitems = data, size, builder.udiv(step, size)
    made.shape, made.strides = cgutils.pack_array(builder, shape), cgutils.pack_array(builder, strides)
    made.meminfo = made.parent = cgutils.get_null_value(cgutils.voidptr_t)
    return made._getvalue()


def _lengths(context: Any, builder: Any, kind: Any, value: Any) -> list[Any]:
    """The lengths that a shape has, one number or several."""
    several = isinstance(kind, types.BaseTuple)
    values = cgutils.unpack_tuple(builder, value) if several else [value]
    kinds = list(kind) if several else [kind]
    return [context.cast(builder, *pair, types.intp) for pair in zip(values, kinds, strict=True)]


def _kind(shape: Any, dtype: Any = types.float64) -> Any:
    return types.Array(dtype, len(shape) if isinstance(shape, types.BaseTuple) else 1, "C")


def _on_stack(is_zero: bool) -> Any:
    def stacked(_: Any, shape: Any, most: Any = None) -> Any:
        kinds = list(shape) if isinstance(shape, types.BaseTuple) else [shape]
        constants = [most] if isinstance(most, types.Integer) else kinds
        if not all(isinstance(each, types.IntegerLiteral) for each in constants):
            return None
        size = int(np.prod([each.literal_value for each in constants]))

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            data = cgutils.alloca_once(builder, ir.DoubleType(), size=ir.Constant(ir.IntType(64), size))
            lengths = _lengths(context, builder, signature.args[0], values[0])
            if is_zero:
                count = context.get_constant(types.intp, 8)
                for length in lengths:
                    count = builder.mul(count, length)
                cgutils.memset(builder, data, count, 0)
            return _array(context, builder, signature.return_type, data, lengths)

        return _kind(shape)(shape, types.Omitted(None) if most is None else most), generate

    return intrinsic(prefer_literal=True)(stacked)


def _at_place(dtype: Any) -> Any:
    def placed(_: Any, room: Any, first: Any, shape: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            vector = context.make_array(signature.args[0])(context, builder, values[0])
            kind = signature.return_type
            data = builder.gep(vector.data, [values[1]])
            data = builder.bitcast(data, context.get_data_type(kind.dtype).as_pointer())
            lengths = _lengths(context, builder, signature.args[2], values[2])
            return _array(context, builder, kind, data, lengths)

        return _kind(shape, dtype)(room, types.intp, shape), generate

    return intrinsic(placed)


@intrinsic
def _called(_: Any, law: Any, *arguments: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> None:
        passed = []
        for kind, value in zip(signature.args[1], cgutils.unpack_tuple(builder, values[1]), strict=True):
            if isinstance(kind, types.Array):
                array = context.make_array(kind)(context, builder, value)
                address = builder.bitcast(array.data, ir.IntType(8).as_pointer())
                passed += [address, *cgutils.unpack_tuple(builder, array.shape)]
            else:
                passed.append(value)
        code = ir.FunctionType(ir.VoidType(), [each.type for each in passed]).as_pointer()
        builder.call(builder.inttoptr(values[0], code), passed)

    plain = tuple(types.unliteral(each) for each in arguments)
    return types.none(law, types.Tuple(plain)), generate


PRIMITIVES = {
    compiled.stacked: _on_stack(is_zero=False),
    compiled.stacked_zeros: _on_stack(is_zero=True),
    compiled.placed: _at_place(types.float64),
    compiled.placed_numbers: _at_place(types.int64),
    compiled.called: _called,
}


# --- entries


def _c_function(entry: Entry) -> Any:
    """Return an entry as a C function: pointers and lengths of its arrays, and its numbers."""
    names: dict[str, Any] = {"carray": carray, "law": dispatcher(entry)}
    given, passed, kinds = [], [], []
    for i, kind in enumerate(entry.arguments):
        given.append(f"a{i}")
        if isinstance(kind, Array):
            lengths = [f"a{i}_{axis}" for axis in range(kind.ndim)]
            given += lengths
            passed.append(f"carray(a{i}, ({', '.join(lengths)},))")
            kinds += [types.CPointer(numba.from_dtype(kind.dtype)), *[types.int64] * kind.ndim]
        else:
            passed.append(f"a{i}")
            kinds.append(types.float64 if kind is compiled.NUMBER else types.int64)
    exec(f"def entry({', '.join(given)}):\n    law({', '.join(passed)})\n", names)
    return numba.cfunc(types.void(*kinds), error_model="numpy")(names["entry"])


def address_of(entry: Entry) -> int:
    """Compile an entry in this process alone; return its address."""
    made = _kept.setdefault(entry, _c_function(entry))
    return int(made.address)


_kept: dict[Entry, Any] = {}  # their machine code lives as long as they do


COUNTING = re.compile(r"^.*call void @NRT_(inc|dec)ref\(.*\n", re.MULTILINE)
"""What counts the owners of memory: kernels own none."""


def llvm_code(entries: Sequence[Entry]) -> str:
    """Compile entries; return their LLVM code, in which they have their names, with what they call."""
    whole, names = binding.parse_assembly(""), {entry.name for entry in entries}
    for entry in entries:
        made = _c_function(entry)
        module = binding.parse_assembly(COUNTING.sub("", made.inspect_llvm()))
        module.get_function(made.native_name).name = entry.name
        whole.link_in(module)
    for each in [*whole.functions, *whole.global_variables]:
        if not each.is_declaration and each.name not in names:
            each.linkage = "internal"
    machine = binding.Target.from_default_triple().create_target_machine()
    passes = binding.create_new_module_pass_manager()
    passes.add_ipsccp_pass()  # no kernel raises an error, so that what would report one is dead
    passes.add_simplify_cfg_pass()
    passes.add_dead_arg_elimination_pass()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.add_strip_symbols_pass()  # numba's names spell out all types
    passes.run(whole, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options()))
    return str(whole)


SHIPPED = (
    "solvers.gear_model.gear_law",
    "solvers.gear_model.fill_outputs",
    "solvers.settling.find_approach",
    "solvers.follower.follow",
    "solvers.follower.add_column_to",
    "solvers.bent_rack.fill_local_poses",
    "tooth_contact.laws.fill_wrench",
    "tooth_contact.line_loads.fill_line_loads",
    "tooth_contact.mesh_loads.fill_mesh_loads",
    "pages.animation.depth_buffer.paint",
)
"""Entries whose code is shipped, by their modules in the package and names."""


def shipped_entries() -> list[Entry]:
    """Return the entries whose code is shipped."""
    places = (name.rpartition(".") for name in SHIPPED)
    return [getattr(import_module(f"rps_exudyn.{module}"), name) for module, _, name in places]


def main() -> int:
    """Write the code of all entries."""
    from rps_exudyn.base import kernel_code

    if binding.llvm_version_info[:2] != kernel_code.LLVM:
        print("numba 0.63 makes the code, which newer llvmlite reads: install it.", file=sys.stderr)
        return 1
    entries = shipped_entries()
    kernel_code.write(llvm_code(entries), entries)
    return 0


if __name__ == "__main__":
    # the module by its own name, which the kernels' types are registered by
    sys.exit(import_module("rps_exudyn.base.kernel_compiler").main())
