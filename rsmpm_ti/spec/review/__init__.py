"""What in a scene is hard to believe: said in sentences before a run, or refused where two things are in one place."""
