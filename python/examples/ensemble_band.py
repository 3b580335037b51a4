"""Two hundred polycrystals: how far the mean number of neighbours is known.

Needs pandas and pyarrow. Prints the confidence interval, and keeps the study in the folder study: started again, it makes only what is missing.
"""

import grainsmooth

if __name__ == "__main__":
    study = grainsmooth.ensemble(
        {"seeding": "random", "levels": 0, "relax": 0},
        {"seeds": [20, 40]},
        replicates=100,
        folder="study",
    )
    summary = study.summary(confidence=0.95)
    for row in summary[summary["figure"] == "neighbors_mean"].to_dict("records"):
        print(f"{row['seeds']} grains have {row['mean']:.2f} neighbours, between {row['low']:.2f} and {row['high']:.2f}")
