"""The command `trace` for vpype: `vpype trace scan.png linesort write out.svg`.

`command` is the command, `options` what it may be told, `pens` a drawing as vpype's layers, and `solids` its solid regions
as lines.
"""
