"""Effects of known size in measured logs of real arms: what is left of the logs is real, and the truth is known.

python -m benchmarks.real_residuals                # every case, and docs/results-real-residuals.md
python -m benchmarks.real_residuals --sample       # one draw in sixteen, to the terminal

Data goes one way: `recordings` reads logs, `pairs` says which belong together, `draws` and `sizing` make an effect of
known size, `insertion` puts it into the second log, `flows` asks the program, `answers` reads what it named, `trial`
holds that against the truth. `bases` and `repeats` are of untouched logs. `claims`, `known_truths` and `page` make the
results of the outcomes that are kept.
"""
