"""Many runs for one question: what varies, running, the table; what matters, how fast, what is best, what fits."""

from model.study.design import Range, Study, Values, make_study
from model.study.running import rows
from model.study.table import read_table, rows_table

__all__ = ["Range", "Study", "Values", "make_study", "read_table", "rows", "rows_table"]
