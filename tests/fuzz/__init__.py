"""Coverage-guided fuzzing of whatever reads what somebody else wrote: files of scenes, pictures, lenses and packs."""
