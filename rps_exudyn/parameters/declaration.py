"""How parameters are declared, read and validated: tables of values with unit, meaning, source and limits.

One declaration serves the TOML reading, the `--set PATH=VALUE` paths, `describe`, the messages about wrong
values and what an HDF5 result stores. Values are SI; text with a unit is converted on the way in.
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from annotated_types import Ge, Gt, Le, Lt
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema
from pydantic_core.core_schema import no_info_before_validator_function

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError, check_kind
from rps_exudyn.base.files import DEEPEST, check_depth, content_of
from rps_exudyn.parameters.distribution import Distribution, is_distribution
from rps_exudyn.parameters.named_file import NamedFile, beside
from rps_exudyn.parameters.retired import context_of
from rps_exudyn.parameters.wrong_values import ConflictError, WrongValue, nearest, problems_of

DEG = math.pi / 180  # for limits of angles
SMALLEST, LARGEST = 1e-30, 1e20  # of all numbers, in SI: powers of others are beyond a computer's numbers

QUANTITY = r"^\s*([+\-−]?\s*[.]?[0-9]|([Ll]og-?)?([Nn]ormal|[Uu]niform)\s*\()"
"""Beginning of text that is a number with its unit, or a distribution: editors check no more of it."""

Source = Literal["paper", "inferred", "estimate", "choice"]
"""Where a value is from; a choice is one of the model, not of the gear."""


@dataclass(frozen=True)
class Unit:
    """The SI unit a field is kept in, and the unit a reader expects."""

    si: str
    display: str
    zero: str = ""  # words for 0, where that means "no value given"

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Text with a unit becomes SI before the field's limits are checked."""
        return no_info_before_validator_function(self._in_si, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """A number in SI within the field's limits, or text with a unit."""
        words = [{"const": self.zero}] if self.zero else []
        return {"anyOf": [handler(core), {"type": "string", "pattern": QUANTITY}, *words]}

    def _in_si(self, value: object) -> float:
        if self.zero and value == self.zero:
            return 0.0
        if type(value) is float:  # most by far: whole tables are validated again where one number changes
            number = value
        elif isinstance(value, str) and is_distribution(value):
            number = Distribution.read(value, self.si).nominal
        else:
            number = units.to_si(value, self.si)
        if math.isfinite(number) and number and not SMALLEST <= abs(number) <= LARGEST:
            raise ValueError(
                f"is {number:g} {self.si}".rstrip()
                + f"; its size must be 0, or between {SMALLEST:g} and {LARGEST:g}"
            )
        return number

    def show(self, value: float) -> str:
        """Return the value with the unit that a reader expects."""
        return units.show(value, self.si, self.display)


@dataclass(frozen=True)
class Listed:
    """A list of numbers kept as text, in SI with commas between; "" without any. In TOML it may be a list."""

    si: tuple[str, ...]  # of the numbers; the last one of all that follow
    counts: tuple[int, ...] = ()  # how many there may be; any number without
    largest: float = LARGEST  # size of each
    text: Callable[[str], object] | None = None  # not None of another text that is allowed

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Lists and texts become one text before the field is checked."""
        return no_info_before_validator_function(self._as_text, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Text, or a list of numbers and texts."""
        return {"anyOf": [handler(core), {"type": "array", "items": {"type": ["number", "string"]}}]}

    def _as_text(self, value: object) -> str:
        if isinstance(value, str):
            if value.strip() in ("", "none"):
                return ""
            if self.text is not None and self.text(value) is not None:
                return value.strip()
            value = value.split(",")
        parts = list(value) if isinstance(value, list | tuple) else [value]
        numbers = [
            units.to_si(part.strip() if isinstance(part, str) else part, self.si[min(i, len(self.si) - 1)])
            for i, part in enumerate(parts)
        ]
        if self.counts and len(numbers) not in self.counts:
            allowed = " or ".join(map(str, self.counts))
            raise ValueError(f"has {len(numbers)} numbers; it must have {allowed}")
        for number in numbers:
            if not abs(number) <= self.largest:
                allowed = f"{self.largest:g} {self.si[0]} either way"
                raise ValueError(f"has the number {number:g}; each must be at most {allowed}")
        return ", ".join(repr(number) for number in numbers)


def numbers_in(text: str) -> tuple[float, ...]:
    """Return the numbers of a `Listed` text."""
    return () if not text else tuple(float(part) for part in text.split(","))


_CLASS = re.compile(r"\s*ISO 1328 class (\d{1,2}), seed (\d{1,9})\s*")


def accuracy_class(text: str) -> tuple[int, int] | None:
    """Return accuracy class and seed of a text such as "ISO 1328 class 8, seed 3"; None of any other.

    Raises:
        ValueError: a text about ISO 1328 that is no such class.
    """
    if "ISO" not in text:
        return None
    found = _CLASS.fullmatch(text)
    if found is None or not 1 <= int(found[1]) <= 11:
        raise ValueError(
            f'is {text!r}; write "ISO 1328 class 8, seed 3", '
            "with a class of 1 to 11 and a whole number as seed"
        )
    return int(found[1]), int(found[2])


def _plain_integer(value: object) -> object:
    """Return the whole number of a numpy integer, and anything else as it is."""
    return int(value) if isinstance(value, Integral) and not isinstance(value, bool) else value


Count = Annotated[int, BeforeValidator(_plain_integer), Field(strict=True)]
Number = Annotated[float, Unit("", "")]
Length = Annotated[float, Unit("m", "mm")]
Angle = Annotated[float, Unit("rad", "deg")]
Force = Annotated[float, Unit("N", "N")]
SpringRate = Annotated[float, Unit("N/m", "N/mm")]
Torque = Annotated[float, Unit("N*m", "N*mm")]
Mass = Annotated[float, Unit("kg", "kg")]
Density = Annotated[float, Unit("kg/m^3", "kg/m^3")]
Pressure = Annotated[float, Unit("Pa", "GPa")]
ContactStiffness = Annotated[float, Unit("N/m^3", "N/m^3")]
LineStiffness = Annotated[float, Unit("N/m^2", "N/mm/um", zero="from the gear")]
Time = Annotated[float, Unit("s", "s")]
Frequency = Annotated[float, Unit("Hz", "Hz")]
Speed = Annotated[float, Unit("rad/s", "rpm")]
SlidingSpeed = Annotated[float, Unit("m/s", "mm/s")]
Inertia = Annotated[float, Unit("kg*m^2", "kg*m^2")]
Torsion = Annotated[float, Unit("N*m/rad", "N*m/rad")]
TorsionDamping = Annotated[float, Unit("N*m*s/rad", "N*m*s/rad")]
Acceleration = Annotated[float, Unit("m/s^2", "m/s^2")]
ViscousDrag = Annotated[float, Unit("N*s/m", "N*s/m")]
Temperature = Annotated[float, Unit("K", "degC")]
Expansion = Annotated[float, Unit("1/K", "1/K")]
WearCoefficient = Annotated[float, Unit("m^2/N", "mm^3/N/m")]
TravelPerTurn = Annotated[float, Unit("m", "mm", zero="as cut")]
CourseAngles = Annotated[str, Listed(("rad",), largest=40.0)]
CourseTravels = Annotated[str, Listed(("m",), largest=1.0)]
PitchErrors = Annotated[str, Listed(("m",), largest=1e-4, text=accuracy_class)]
Stiffnesses = Annotated[str, Listed(("N/m", "N/m", "N/m", "N*m/rad"), counts=(6, 36))]


def parameter(default: Any, meaning: str, source: Source = "estimate", **limits: Any) -> Any:
    """Declare one parameter: its default (text with unit, or SI), its meaning, the source of its value."""
    return Field(default, description=meaning, json_schema_extra={"source": source}, **limits)


class Table(BaseModel):
    """A group of parameters: one TOML table, or several nested ones."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", validate_default=True, allow_inf_nan=False, hide_input_in_errors=True
    )

    not_in_files: ClassVar[tuple[str, ...]] = ()  # tables that settings reach, but no file

    def __init__(self, **tables: Any) -> None:
        """Build it from nested tables or dictionaries.

        Raises:
            InputError: parameters that are wrong (all of them at once).
        """
        try:
            super().__init__(**tables)
        except ValidationError as error:
            problems = problems_of(type(self), error, tables)
        else:
            return
        raise InputError(problem.sentence for problem in problems)

    # Pydantic's own mark of a constructor that validation of nested tables may pass by
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def conflicts(self) -> "Iterator[WrongValue]":
        """Yield what is wrong between parameters that are each fine alone."""
        yield from ()

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if conflicts := list(self.conflicts()):
            raise ConflictError(conflicts)
        return self

    @classmethod
    def from_toml(cls, path: str | Path, settings: Mapping[str, object] | None = None) -> Self:
        """Read the tables of a TOML file, with single parameters replaced by `settings` (path -> value).

        Raises:
            InputError: unreadable file, no TOML, or parameters that are wrong (all of them at once).
        """
        return cls.from_tables(cls.tables_in(path), settings, where=str(path))

    @classmethod
    def tables_in(cls, path: str | Path) -> dict[str, Any]:
        """Return the tables of a TOML file; files that it names are sought beside it."""
        return beside(read_toml(path), Path(path).parent, named_files(cls))

    @classmethod
    def from_tables(
        cls,
        tables: Mapping[str, Any],
        settings: Mapping[str, object] | None = None,
        where: str = "",
        context: Mapping[str, bool] | None = None,
    ) -> Self:
        """Build it from nested dictionaries; `where` names their origin in messages. In the context
        `retired.STORED` choices of earlier versions are read.

        Raises:
            InputError: parameters that are wrong (all of them at once).
        """
        check_kind("tables", tables, Mapping, 'a table of tables, such as {"yoke": {"preload": "400 N"}}')
        check_settings(settings or {})
        merged = _merged(tables, settings or {})
        try:
            return cls.model_validate(merged, context=context)
        except ValidationError as error:
            problems = problems_of(cls, error, merged, settings or {})
        raise InputError(
            problem.sentence
            if problem.concerns(settings or {})
            else f"{where}: {problem.sentence}".lstrip(": ")
            for problem in problems
        )

    def replace(self, settings: Mapping[str, object], where: str = "") -> Self:
        """Return the same with single parameters changed: {"yoke.preload": "400 N"}.

        Only the tables that change are validated again, and what must fit together.

        Raises:
            InputError: an unknown path, or a value that is not allowed.
        """
        check_settings(settings)
        context = context_of(settings)
        if settings and all(self._stands_alone(path) for path in settings):
            with suppress(ValidationError):  # the whole is validated then, and its error stated
                return type(self).model_validate(self._with(settings), context=context)
        return self.from_tables(self.model_dump(), settings, where, context)

    def _stands_alone(self, path: str) -> bool:
        """Return whether a path may be that of a parameter from which nothing follows."""
        table, _, name = path.partition(".")
        return bool(name) == isinstance(getattr(self, table, None), Table)

    def _with(self, settings: Mapping[str, object]) -> dict[str, Any]:
        """The tables, those that settings change taken apart."""
        tables = _parts(self)
        for path in settings:
            name, _, parameter = path.partition(".")
            if parameter and isinstance(tables.get(name), Table):
                tables[name] = _parts(tables[name])
        return _merged(tables, settings)

    def changes(self) -> dict[str, Any]:
        """Return path -> value of all parameters that differ from their defaults."""
        usual, declared = type(self)(), all_declared(type(self))
        values = {path: self.value_at(path) for path in declared}
        return {path: value for path, value in values.items() if value != usual.value_at(path)}

    def changes_shown(self) -> list[str]:
        """Return the same for a reader: "yoke.preload 400 N"."""
        declared = all_declared(type(self))
        return [f"{path} {declared[path].show(value)}" for path, value in self.changes().items()]

    def value_at(self, path: str) -> Any:
        """Return the value of the parameter at a dotted path."""
        value: Any = self
        for name in path.split("."):
            value = getattr(value, name)
        return value

    def set_among(self, paths: Iterable[str]) -> list[str]:
        """Return those of some paths at which a value other than 0 or an empty text stands."""
        return [path for path in paths if self.value_at(path)]

    @classmethod
    def declared(cls) -> Iterator["Declared"]:
        """Yield all parameters, those of nested tables too, in the order of their declaration."""
        for name, field in cls.model_fields.items():
            if isinstance(field.annotation, type) and issubclass(field.annotation, Table):
                for item in field.annotation.declared():
                    yield replace(item, path=f"{name}.{item.path}")
            else:
                unit = next((item for item in field.metadata if isinstance(item, Unit)), None)
                yield Declared(name, field, unit)

    @classmethod
    def declared_at(cls, path: str) -> list["Declared"]:
        """Return the parameter at a dotted path, or all of a table; every parameter for "".

        Raises:
            InputError: there is no such parameter or table.
        """
        check_settings({path: None})
        declared = all_declared(cls)
        if path in declared:
            return [declared[path]]
        found = [item for name, item in declared.items() if f"{name}.".startswith(f"{path}." if path else "")]
        if not found:
            raise InputError(f"{path} is no parameter; {nearest(cls, path)}.")
        return found


def check_settings(settings: object) -> None:
    """Check that settings are a table whose keys are texts, without quotes or blanks around them.

    Raises:
        InputError: they are not.
    """
    check_kind("a change", settings, Mapping, 'path -> value, such as {"yoke.preload": "400 N"}')
    assert isinstance(settings, Mapping)
    for path in settings:
        if not isinstance(path, str) or path != path.strip(BLANKS):
            check_kind("a parameter's path", path, str, "text, such as yoke.preload")
            raise InputError(
                f"{units.shown(path)} is no parameter; write {path.strip(BLANKS)}, without quotes."
            )


BLANKS = " \t'\""


@cache
def named_files(table: type[Table]) -> tuple[str, ...]:
    """Paths of the parameters that name files."""
    declared = all_declared(table).values()
    return tuple(each.path for each in declared if any(isinstance(m, NamedFile) for m in each.field.metadata))


@cache
def all_declared(table: type[Table]) -> Mapping[str, "Declared"]:
    """Path -> parameter; a table asks for one of them many times."""
    return {item.path: item for item in table.declared()}


@dataclass(frozen=True)
class Declared:
    """One declared parameter, as `describe` shows it."""

    path: str
    field: FieldInfo
    unit: Unit | None

    @property
    def meaning(self) -> str:
        return self.field.description or ""

    @property
    def source(self) -> Source:
        extra = self.field.json_schema_extra
        assert isinstance(extra, dict)
        return extra["source"]  # type: ignore[return-value]

    @property
    def default(self) -> Any:
        """Value where nothing is set, in SI."""
        usual = self.field.default
        return units.to_si(usual, self.unit.si) if self.unit else usual

    @property
    def allowed(self) -> str:
        """Values allowed, in the display unit: "more than 0 mm and at most 20 mm"."""
        if self.field.annotation is str:
            return "text"
        if choices := get_args(self.field.annotation):
            return " or ".join(str(choice) for choice in choices)
        shown = self.unit.show if self.unit else str
        limits = [
            f"{word} {shown(getattr(limit, attribute))}"
            for kind, attribute, word in _LIMITS
            for limit in self.field.metadata
            if isinstance(limit, kind)
        ]
        noun = ["a whole number"] if self.field.annotation is int else []
        allowed = ", ".join([*noun, " and ".join(limits)]) if limits else "any number"
        return f'{allowed}, or "{self.unit.zero}"' if self.unit and self.unit.zero else allowed

    @property
    def most(self) -> Any:
        """Largest value allowed, in SI; inf where there is none."""
        return next((limit.le for limit in self.field.metadata if isinstance(limit, Le)), math.inf)

    def show(self, value: Any) -> str:
        """Return the value with the unit that a reader expects, or the words that stand for 0."""
        if self.unit is None:
            return str(value) if value != "" else "none"
        return self.unit.zero if self.unit.zero and not value else self.unit.show(value)


_LIMITS = ((Gt, "gt", "more than"), (Ge, "ge", "at least"), (Lt, "lt", "less than"), (Le, "le", "at most"))


_KEY = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?<![\w\-.\"'])(?:{_KEY}[ \t]*\.[ \t]*){{{DEEPEST}}}")


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Raises:
        InputError: the file cannot be read or is no TOML.
    """
    import tomllib

    content = content_of(path)
    try:
        text = content.decode("utf-8-sig")  # spreadsheets begin with a mark
        if _LONG_KEY.search(text):  # its reader takes a time that grows with the square of the parts
            raise ValueError(f"it has a key of more than {DEEPEST} parts")
        tables = tomllib.loads(text)
        check_depth(tables, "its text")
        return tables
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a TOML file: it is not UTF-8 text.") from None
    except (ValueError, RecursionError) as error:  # no TOML, a number too long, or nested too deep
        raise InputError(f"{path} is not a TOML file: {error}.") from None


def _parts(table: Table) -> dict[str, Any]:
    """A table's parameters, which are no tables themselves."""
    return {name: getattr(table, name) for name in type(table).model_fields}


def _merged(tables: Mapping[str, Any], settings: Mapping[str, object]) -> dict[str, Any]:
    """The tables with the settings in their places, known or not: validation looks at them together."""
    merged: dict[str, Any] = {
        name: dict(table) if isinstance(table, Mapping) else table for name, table in tables.items()
    }
    for path, value in settings.items():
        table, name = merged, path
        while "." in name and isinstance(inner := table.get(name.partition(".")[0], {}), Mapping | Table):
            part, _, name = name.partition(".")
            table[part] = table = dict(inner) if isinstance(inner, Mapping) else _parts(inner)
        if table is not merged or "." not in name:  # else what is no table of the gear is refused itself
            table[name] = value
    return merged
