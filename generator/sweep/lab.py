"""Where a sweep's jobs are done: this machine. Building side by side, timing alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ..choice.kernel import Code, Emitted, Rejected, Verified
from ..choice.trials import Rules
from ..choice.workbench import TimingJob, Workbench, side_by_side
from ..errors import EmissionError
from ..evidence.records.code import emission_hash, key_of
from ..registry.names import name_of, source_name_of
from ..registry.question import Contest
from ..registry.variant import Variant
from ..targets.host import read_host
from ..targets.target import Target
from ..toolchain.flags import compile_flags


class Lab:
    """A workbench whose jobs are records. `cpu`: the target and the model name of what times."""

    def __init__(self, bench: Workbench, target: Target, workers: int | None = None) -> None:
        self.bench = bench
        self.target = target
        self.workers = workers
        self.compilers = {c.code: c.version for c in bench.compilers.values()}
        self.cpu = self._cpu()

    def _cpu(self) -> str:
        return f"{self.target.name}, {read_host().cpu}"

    def rules(self, contest: Contest) -> Rules:
        """What figures depend on besides the kernel."""
        return self.bench.rules(contest, self.cpu)

    def emit(self, variant: Variant) -> Emitted:
        """EmissionError says what is wrong, whatever it is, though no rule of the registry does."""
        try:
            return self.bench.emit(variant, self.target)
        except Exception as error:  # a bug in laying one out must not end a sweep of thousands
            what = f"{type(error).__name__}: {error}"
            raise EmissionError(f"{name_of(variant)}: emission: {what}") from error

    def code(self, variant: Variant) -> Code:
        """What the compiler would be given. Raises EmissionError, as `emit` does.

        Without emitting it where an earlier run did, by the same sources of the generator.
        """
        key = key_of(source_name_of(variant), emission_hash())
        made = self.bench.store.kept("hashes of texts", key, lambda: self.emit(variant).code.source)
        compiler = self.bench.compilers[variant["compiler"]]
        return Code(made, compiler.version, compile_flags(variant, compiler, self.target))

    def build(self, kernels: Sequence[Emitted]) -> Iterator[tuple[Emitted, Verified | Rejected]]:
        """Build and verify them side by side; each as it is done. Nothing runs when it ends."""
        for kernel in kernels:
            self.bench.cases.of(kernel.variant)  # made once, not by each thread
        yield from side_by_side(self.bench.check, kernels, self.workers)

    def time(self, job: TimingJob) -> dict[str, Any]:
        """What carom_bench measured, alone on the machine, as far as that is ours to say.

        Raises KernelError where a kernel of the job ends it.
        """
        return self.bench.time(job)
