"""Effects hidden in arms in MuJoCo: what `discover` names, how well it predicts, and what it says it cannot tell.

python -m benchmarks.hidden_effects            # every case, and docs/results-discovery.md
python -m benchmarks.hidden_effects --sample   # one case in eight, to the terminal

A case is a name; its name is its seed. `cases` lists them, `drawing` draws joints and sizes, `trial` runs one,
`oracle` says what could be known at best, `claims` and `page` make the results of the outcomes that are kept.
"""
