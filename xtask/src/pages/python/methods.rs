//! What the data classes of Python can do beside holding their fields.

/// Methods of a class beside its fields.
pub const METHODS: [(&str, &str); 7] = [
    (
        "ExpectationResult",
        r#"
    def __str__(self) -> str:
        what = f"{self.drive}: {self.name}: {self.outcome.value.replace('_', ' ')}"
        return f"{what}: expected {self.expected}; actual: {self.actual} at {self.time} s"
"#,
    ),
    (
        "StatusReport",
        r#"
    @property
    def runs(self) -> bool:
        """Whether the drive runs."""
        return self.verdict == "runs"

    def __bool__(self) -> bool:
        return self.runs

    def _repr_html_(self) -> str:
        """It in words and its values, for notebooks."""
        from profidrive._render import status

        return status(self)
"#,
    ),
    (
        "ScanReport",
        r#"
    def __len__(self) -> int:
        return len(self.stations)

    def __iter__(self) -> Iterator[Scanned]:
        return iter(self.stations)

    def __getitem__(self, place: int) -> Scanned:
        return self.stations[place]

    def _repr_html_(self) -> str:
        """The stations in a table, for notebooks."""
        from profidrive._render import stations

        return stations(self)
"#,
    ),
    (
        "DiffReport",
        r#"
    def _repr_html_(self) -> str:
        """The differences in a table, for notebooks."""
        from profidrive._render import differences

        return differences(self)
"#,
    ),
    ("Parameter", TO_PINT),
    ("ParameterReading", TO_PINT),
    ("Quantity", TO_PINT),
];

/// The only method that knows another package for units.
const TO_PINT: &str = r#"
    def to_pint(self, ureg: UnitRegistry[Any]) -> pint.Quantity[Any]:
        """Returns the number as a quantity of pint.

        Raises:
            UsageError: where there is no number, or pint does not have its unit.
        """
        from profidrive.units import to_pint

        return to_pint(self.value, self.unit, ureg)
"#;

/// What is imported for them, where a file has them.
pub const IMPORTS: [(&str, &str, &str); 2] = [
    ("Iterator[", "import Mapping\n", "import Iterator, Mapping\n"),
    (
        "UnitRegistry",
        "from typing import Any, TypeAlias\n\nfrom profidrive.types import State as State\n",
        "from typing import TYPE_CHECKING, Any, TypeAlias\n\nfrom profidrive.types import State as State\n\n\
         if TYPE_CHECKING:\n    import pint\n    from pint import UnitRegistry\n",
    ),
];
