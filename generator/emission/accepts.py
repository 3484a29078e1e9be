"""What a template accepts, on its first line; checked each time that it is filled.

    {% accepts k: emission.context.KernelContext, lanes: lowering.lanes.LaneContext | None %}
    {% accepts lanes: lowering.lanes.LaneContext if lanes.width in (4, 8) %}
    {% accepts nothing %}

A type is named as in the generator, or as Python calls one of its own; a derived one is as good.
"""

from __future__ import annotations

from jinja2 import nodes
from jinja2.ext import Extension
from jinja2.parser import Parser


class Accepts(Extension):
    """The tag `accepts`."""

    tags = {"accepts"}  # noqa: RUF012 - so Jinja wants it

    def parse(self, parser: Parser) -> nodes.Node:
        stream = parser.stream
        line = next(stream).lineno
        pairs: list[nodes.Pair] = []
        kinds: list[tuple[str, ...]] = []
        if not stream.skip_if("name:nothing"):
            while not pairs or stream.skip_if("comma"):
                name = stream.expect("name").value
                stream.expect("colon")
                pairs.append(nodes.Pair(nodes.Const(name), nodes.Name(name, "load")))
                kinds.append(self._kinds(parser))
        holds: nodes.Expr = nodes.Const(True)
        if stream.skip_if("name:if"):
            holds = parser.parse_expression()
        given = [nodes.Const(parser.name), nodes.Dict(pairs), nodes.Const(tuple(kinds)), holds]
        return nodes.ExprStmt(self.call_method("check", given), lineno=line).set_lineno(line)

    def _kinds(self, parser: Parser) -> tuple[str, ...]:
        """The types of one name, between `|`."""
        kinds = [self._kind(parser)]
        while parser.stream.skip_if("pipe"):
            kinds.append(self._kind(parser))
        return tuple(kinds)

    @staticmethod
    def _kind(parser: Parser) -> str:
        words = [parser.stream.expect("name").value]
        while parser.stream.skip_if("dot"):
            words.append(parser.stream.expect("name").value)
        return ".".join(words)

    @staticmethod
    def check(
        template: str, given: dict[str, object], kinds: tuple[tuple[str, ...], ...], holds: object
    ) -> None:
        """Raises TypeError where a template is given something else than it accepts."""
        for (name, value), wanted in zip(given.items(), kinds, strict=True):
            is_a = {f".{t.__module__}.{t.__qualname__}" for t in value.__class__.__mro__}
            names = {"None": "NoneType"}
            ends = tuple(f".{names.get(kind, kind)}" for kind in wanted)
            if not any(each.endswith(ends) for each in is_a):
                kind = type(value).__name__
                raise TypeError(f"{template}: {name} is {kind}; accepted: {' | '.join(wanted)}")
        if not holds:
            raise TypeError(f"{template}: its condition on {', '.join(given)} does not hold")
